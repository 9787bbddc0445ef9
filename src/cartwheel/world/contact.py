"""Converts Gazebo's contact parameters to MuJoCo's.

For derivations, see ``docs/physics.md``. In short:

- In Gazebo, the smaller of two coefficients is the friction of a pair. MuJoCo uses the parameters
  of the geom with the higher priority, so priorities that rise as mu falls give the same rule.
- ``kp`` and ``kd`` are a spring and a damper against the body's mass m. In MuJoCo's terms, they are
  a time constant 1/(ζω) and a damping ratio ζ with ω = √(kp/m), ζ = kd/(2√(kp m)). The contact is
  limited to the stiffness that the time step allows, and bounces only with restitution.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import mujoco

from cartwheel.description.model import NO_BOUNCE, Surface
from cartwheel.errors import Origin
from cartwheel.geometry import Vec3
from cartwheel.world.additions import Added, Addition
from cartwheel.world.entry import collision_of, scoped
from cartwheel.world.tyres import Tread

DEFAULT_MU = 1.0
"""Default friction coefficient, as in Gazebo."""
DEFAULT_KP = 1e12
DEFAULT_KD = 1.0
STIFFEST_TIME_CONSTANT = 0.01
"""s; a rigid contact, for time steps up to half of this value."""
SOFTEST_TIME_CONSTANT = 0.1
"""s; with a larger value, a body would visibly sink."""
IMPEDANCE = (0.95, 0.99, 0.0005, 0.5, 2.0)
"""MuJoCo's solimp: the enforced fraction of the constraint at depths of 0.5 mm and more."""
FRICTION_TIME_CONSTANT = 0.03
"""Time constant for the decay of slip within the friction limit, s. Below mu g T/2, friction is
viscous.
"""
TRAILING_TIME_CONSTANT = 0.4
"""The same for parts that a robot drags on the ground of its wheels, such as a fixed caster, s.

The wheels prevent creep, and friction that stops such a part at once would throw it up.
"""
SCRUBBING_TIME_CONSTANT = 0.12
"""The same for tracks, and for wheels that slide sideways, such as those of skid steers in a turn,
and those of casters without trail, s.
"""
SCRUBBING_IMPEDANCE = (0.2, 0.95, 0.0005, 0.5, 2.0)
"""MuJoCo's solimp for both, which rises from 0.2 at the surface to 0.95 at a depth of 0.5 mm.

They sink by about g T² / 2, with the time constant T of the contact, which is more than the sliding
friction lifts them. A wheel that is lifted further is held by a softer contact, so that it does not
hop, also if the load on the wheels of both sides differs.
"""
TORSION = 0.005
"""m; MuJoCo's default, which contacts with three dimensions do not use."""
ALL_BITS = 0xFFFF
"""SDF's default for both bitmasks."""
FRICTION_IMPEDANCE_RATIO = 100.0
"""Stiffness of friction relative to the normal direction: reduces creep under a constant load."""
_MESH_AREA = 1.0


@dataclass(frozen=True, kw_only=True, slots=True)
class BuiltSurface:
    """A collision geom with its contact properties."""

    name: str
    """Name of the geom."""
    body: str
    """Name of its body."""
    model: str
    moves: bool
    """Whether there is a joint between the geom and the world."""
    rolls: bool
    """Whether it is a wheel."""
    tread: Tread | None
    """The tread of a wheel that may roll on the ground."""
    bottom: float | None
    """Lowest point in the model, m, for geoms fixed to a free root; otherwise None."""
    low: float | None
    """Lowest point in the model, m, for undriven geoms that turn about the vertical."""
    floor_area: float
    """Area on which others may slide, m²; see `floor_area`."""
    friction: tuple[float, float, float]
    reference: tuple[float, float]
    surface: Surface
    origin: Origin
    direction: tuple[str, Vec3] | None = None
    """The direction in which mu1 applies, in a body's axes; None if the description states none."""
    trails: bool = False
    """Whether the robot drags it on the ground of its wheels; see `dragging`."""
    scrubs: bool = False
    """Whether it is a wheel that slides sideways when its robot turns."""
    pulls: bool = False
    """Whether it is a wheel of a robot that also drags parts, for which it needs stiff friction."""
    slips: bool = False
    """Whether it is a wheel whose slip a plugin controls, so that its contact must not add any."""
    travels: bool = False
    """Whether it is a track or a belt, whose surface moves."""

    @property
    def slides(self) -> bool:
        """Whether it slides on the ground in ordinary motion."""
        return self.scrubs or not self.rolls

    @property
    def scrubs_softly(self) -> bool:
        """Whether it is a track, or a wheel with the soft contact of skid steers."""
        return self.travels or (self.scrubs and not (self.pulls or self.slips))

    @property
    def friction_time(self) -> float | None:
        """Time constant for the decay of slip on fixed surfaces, s; None for the contact's own."""
        if self.trails:
            return TRAILING_TIME_CONSTANT
        if self.scrubs_softly:
            return SCRUBBING_TIME_CONSTANT
        return None if self.rolls else FRICTION_TIME_CONSTANT

    def added(self, addition: Addition, value: float) -> Added:
        """An addition to the collision of this geom."""
        name = collision_of(self.name)
        return Added(
            addition=addition,
            model=self.model,
            element=name.removeprefix(scoped(self.model, "")),
            value=value,
            origin=self.origin,
        )


@dataclass(frozen=True, kw_only=True, slots=True)
class Bounce:
    """A geom with restitution; only pairs of such geoms bounce."""

    geom: str
    restitution: float
    """Speed after an impact divided by speed before it; the smaller value of two surfaces is used.
    """
    threshold: float
    """m/s; slower impacts do not bounce. The smaller value of two surfaces is used."""


def floor_area(kind: mujoco.mjtGeom, size: Sequence[float]) -> float:
    """Area to slide on, m²: for a box, the largest face that may be level.

    Args:
        kind: The geom's type.
        size: The geom's size.
    """
    kinds = mujoco.mjtGeom
    if kind in (kinds.mjGEOM_PLANE, kinds.mjGEOM_HFIELD):
        return math.inf
    if kind == kinds.mjGEOM_BOX:
        return float(4 * size[0] * size[1])
    if kind == kinds.mjGEOM_CYLINDER:
        return float(math.pi * size[0] ** 2)
    # Only the compiler knows a mesh's size; it may be a floor.
    return _MESH_AREA if kind == kinds.mjGEOM_MESH else 0.0


def bounce(geom: str, surface: Surface) -> Bounce | None:
    """The restitution of a surface; None without one."""
    restitution, threshold = surface.restitution, surface.bounce_threshold
    if not restitution:
        return None
    # As in Gazebo, the threshold of the other surface can be lower.
    threshold = NO_BOUNCE if threshold is None else threshold
    return Bounce(geom=geom, restitution=min(restitution, 1.0), threshold=threshold)


def bounces_of(surfaces: Iterable[BuiltSurface]) -> tuple[Bounce, ...]:
    """The surfaces with restitution; none if no impact of them can bounce."""
    found = [bounce(each.name, each.surface) for each in surfaces]
    bounces = tuple(each for each in found if each is not None)
    reachable = any(each.threshold < NO_BOUNCE for each in bounces)
    return bounces if reachable else ()


def friction(surface: Surface) -> tuple[float, float, float]:
    """Sliding, torsional and rolling friction of a geom.

    If mu1 and mu2 differ, the mean is used, for contacts without an explicit pair.
    """
    return (sum(coefficients(surface)) / 2, TORSION, 0.0001)


def coefficients(surface: Surface) -> tuple[float, float]:
    """mu1 and mu2; if only one is stated, it applies in both directions."""
    mu1 = DEFAULT_MU if surface.mu1 is None else surface.mu1
    mu2 = mu1 if surface.mu2 is None else surface.mu2
    # Coefficients above 100 only worsen the conditioning: no wheel slips at 100.
    return min(mu1, 100.0), min(mu2, 100.0)


def masks(surface: Surface) -> tuple[int, int]:
    """MuJoCo's contype and conaffinity: the category of a surface, and what it collides with."""
    if surface.collide_without_contact:
        return 0, 0
    collide = ALL_BITS if surface.collide_bitmask is None else surface.collide_bitmask
    category = collide if surface.category_bitmask is None else surface.category_bitmask
    return _signed(category), _signed(collide)


def masks_fit(first: Surface, second: Surface) -> bool:
    """Whether two surfaces may collide: the category of one is in the mask of the other."""
    (category, collide), (other, others) = masks(first), masks(second)
    return bool(category & others or other & collide)


def _signed(bits: int) -> int:
    """An unsigned 32-bit mask as the engine's signed integer."""
    return bits - (1 << 32) if bits >= 1 << 31 else bits


def reference(surface: Surface, mass: float, step: float) -> tuple[float, float]:
    """MuJoCo's solref: time constant in s and damping ratio.

    Args:
        surface: ``kp`` in N/m and ``kd`` in N s/m, with Gazebo's defaults.
        mass: Mass of the model on the contact, kg.
        step: Time step, s.
    """
    kp = DEFAULT_KP if surface.kp is None else max(surface.kp, 1.0)
    kd = DEFAULT_KD if surface.kd is None else max(surface.kd, 0.0)
    omega = math.sqrt(kp / max(mass, 1e-3))
    ratio = max(1.0, kd / (2 * math.sqrt(kp * max(mass, 1e-3))))
    shortest = max(STIFFEST_TIME_CONSTANT, 2 * step)
    constant = min(max(1 / (ratio * omega), shortest), SOFTEST_TIME_CONSTANT)
    return constant, min(ratio, 10.0)


def priorities(coefficients: Iterable[float]) -> dict[float, int]:
    """A MuJoCo priority for each friction coefficient, rising as the coefficient falls."""
    ordered = sorted(set(coefficients), reverse=True)
    return {mu: rank for rank, mu in enumerate(ordered)}
