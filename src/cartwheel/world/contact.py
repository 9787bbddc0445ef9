"""Gazebo's contact parameters as MuJoCo's.

Derivations stand in ``docs/physics.md``. In short:

- Friction of a pair is the smaller of the two coefficients in Gazebo. MuJoCo takes the
  parameters of the geom with the higher priority: priorities that rise as mu falls keep
  Gazebo's rule.
- ``kp`` and ``kd`` are a spring and a damper against the body's mass m: in MuJoCo's terms
  a time constant 1/(ζω) and a damping ratio ζ with ω = √(kp/m), ζ = kd/(2√(kp m)), no
  stiffer than a contact can be at this step, and never bouncing where no restitution is asked for.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from cartwheel.description.model import Surface
from cartwheel.geometry import Vec3
from cartwheel.world.tyres import Tread

DEFAULT_MU = 1.0
"""Where a description states none, as in Gazebo."""
DEFAULT_KP = 1e12
DEFAULT_KD = 1.0
STIFFEST_TIME_CONSTANT = 0.01
"""s; a rigid contact, as long as the step is not longer than half of it."""
SOFTEST_TIME_CONSTANT = 0.1
"""s; beyond it a body would visibly sink."""
IMPEDANCE = (0.95, 0.99, 0.0005, 0.5, 2.0)
"""MuJoCo's solimp: how much of the constraint is kept at and beyond 0.5 mm of depth."""
FRICTION_TIME_CONSTANT = 0.03
"""s; in which a slip that the friction can hold dies out. Below mu g T/2 friction is viscous."""
TRAILING_TIME_CONSTANT = 0.4
"""s; the same of what a robot drags along on its wheels' ground, as a caster that does not turn.

Its wheels keep it from creeping, and friction that stops it at once throws it up."""
TORSION = 0.005
"""m; MuJoCo's own, which no contact of three dimensions looks at."""
NO_BOUNCE = 1e5
"""m/s; SDF's default threshold, which nothing reaches."""
ALL_BITS = 0xFFFF
"""SDF's default of both bitmasks."""
FRICTION_IMPEDANCE_RATIO = 100.0
"""How much harder friction holds than the normal direction: less creep under a steady load."""


@dataclass(frozen=True, kw_only=True, slots=True)
class BuiltSurface:
    """A colliding geom of a spec, and what decides how it touches others."""

    geom: Any
    name: str
    model: str
    moves: bool
    """Whether any joint lies between it and the world."""
    rolls: bool
    """Whether it is a wheel."""
    tread: Tread | None
    """Of a wheel that may roll on the ground."""
    bottom: float | None
    """How low it reaches in its model, where it is fixed to its root and nothing holds that; m."""
    friction: tuple[float, float, float]
    reference: tuple[float, float]
    surface: Surface
    direction: tuple[str, Vec3] | None = None
    """Along which mu1 counts, in the axes of a body; None where the description states none."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Bounce:
    """A geom that throws back what meets it, if that bounces too."""

    geom: str
    restitution: float
    """Speed after an impact by speed before; of two surfaces the smaller counts."""
    threshold: float
    """m/s: what meets more slowly does not bounce; of two surfaces the smaller counts."""


def bounce(geom: str, surface: Surface) -> Bounce | None:
    """How a surface bounces; None where it does not, as without a threshold in Gazebo."""
    restitution, threshold = surface.restitution, surface.bounce_threshold
    if not restitution or threshold is None or threshold >= NO_BOUNCE:
        return None
    return Bounce(geom=geom, restitution=min(restitution, 1.0), threshold=threshold)


def friction(surface: Surface) -> tuple[float, float, float]:
    """Sliding, torsional and rolling friction of a geom.

    Where mu1 and mu2 differ it is their mean, for contacts that no pair is stated for.
    """
    return (sum(coefficients(surface)) / 2, TORSION, 0.0001)


def coefficients(surface: Surface) -> tuple[float, float]:
    """mu1 and mu2; a surface that states one of them has it in both directions."""
    mu1 = DEFAULT_MU if surface.mu1 is None else surface.mu1
    mu2 = mu1 if surface.mu2 is None else surface.mu2
    # A coefficient beyond 100 only spoils the conditioning: no wheel slips at 100.
    return min(mu1, 100.0), min(mu2, 100.0)


def masks(surface: Surface) -> tuple[int, int]:
    """MuJoCo's contype and conaffinity: what a surface is, and what it touches."""
    if surface.collide_without_contact:
        return 0, 0
    collide = ALL_BITS if surface.collide_bitmask is None else surface.collide_bitmask
    category = collide if surface.category_bitmask is None else surface.category_bitmask
    return _signed(category), _signed(collide)


def masks_fit(first: Surface, second: Surface) -> bool:
    """Whether two surfaces may touch: one of them is of what the other touches."""
    (category, collide), (other, others) = masks(first), masks(second)
    return bool(category & others or other & collide)


def _signed(bits: int) -> int:
    """32 bits as the engine's integers hold them."""
    return bits - (1 << 32) if bits >= 1 << 31 else bits


def reference(surface: Surface, mass: float, step: float) -> tuple[float, float]:
    """MuJoCo's solref: time constant in s and damping ratio.

    Args:
        surface: Its ``kp`` in N/m and ``kd`` in N s/m, Gazebo's defaults where not stated.
        mass: Of the model that rests on the contact, kg.
        step: Of the simulation, s.
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
