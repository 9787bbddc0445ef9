"""``gz-sim-hydrodynamics-system``: the forces of water on a moving body."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, ClassVar, TypeVar

import numpy as np

from cartwheel.component import Scope, Shared
from cartwheel.description.model import Element, Link
from cartwheel.devices.water.hydrodynamics import Hydrodynamics, HydrodynamicsConfig
from cartwheel.dialects.catalogue import short_name
from cartwheel.dialects.gz.drive_tags import gz_name
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import number_at, tag
from cartwheel.geometry import Array
from cartwheel.simulation import Part

T = TypeVar("T")
_FORCES, _VELOCITIES = "xyzkmn", "UVWPQR"
"""Names of the forces and torques, and of the linear and angular velocities, by SNAME (1950)."""
_MOTIONS = ("surge", "sway", "heave", "roll", "pitch", "yaw")
_COEFFICIENTS = frozenset(
    "".join(parts)
    for force in _FORCES
    for parts in (
        *itertools.product(force, _VELOCITIES),
        *itertools.product(force, ("Dot",), _VELOCITIES),
        *itertools.product(force, _VELOCITIES, ("", "abs"), _VELOCITIES),
    )
)
"""All tags that are coefficients, including the products of different axes."""


def _stated_mass(link: Link | None) -> Array:
    """The added mass in a link's inertial, shape (6, 6)."""
    matrix = np.zeros((6, 6))
    if link is not None and link.inertial is not None and link.inertial.added_mass:
        matrix[np.triu_indices(6)] = link.inertial.added_mass
        matrix += np.triu(matrix, 1).T
    return matrix


def _tag(axis: int, infix: str, what: str) -> Any:
    """A coefficient of one axis."""
    force, velocity = _FORCES[axis], _VELOCITIES[axis]
    turns = axis > 2
    units = {
        "Dot": ("kg", "kg m²"),
        "": ("kg/s", "kg m²/s"),
        "abs": ("kg/m", "kg m²"),
    }
    name = f"{force}{velocity}abs{velocity}" if infix == "abs" else f"{force}{infix}{velocity}"
    return tag(
        name,
        default=0.0,
        unit=units[infix][turns],
        doc=f"{what} in {_MOTIONS[axis]}. Resistance is negative.",
    )


@dataclass(frozen=True, kw_only=True, slots=True)
class HydrodynamicsParameters:
    link: str = tag("link_name", role="link", doc="Link on which the forces act.")
    xU: float = _tag(0, "", "Linear damping")  # noqa: N815 - the tag's name
    yV: float = _tag(1, "", "Linear damping")  # noqa: N815
    zW: float = _tag(2, "", "Linear damping")  # noqa: N815
    kP: float = _tag(3, "", "Linear damping")  # noqa: N815
    mQ: float = _tag(4, "", "Linear damping")  # noqa: N815
    nR: float = _tag(5, "", "Linear damping")  # noqa: N815
    xUabsU: float = _tag(0, "abs", "Quadratic damping")  # noqa: N815
    yVabsV: float = _tag(1, "abs", "Quadratic damping")  # noqa: N815
    zWabsW: float = _tag(2, "abs", "Quadratic damping")  # noqa: N815
    kPabsP: float = _tag(3, "abs", "Quadratic damping")  # noqa: N815
    mQabsQ: float = _tag(4, "abs", "Quadratic damping")  # noqa: N815
    nRabsR: float = _tag(5, "abs", "Quadratic damping")  # noqa: N815
    xDotU: float = _tag(0, "Dot", "Added mass")  # noqa: N815
    yDotV: float = _tag(1, "Dot", "Added mass")  # noqa: N815
    zDotW: float = _tag(2, "Dot", "Added mass")  # noqa: N815
    kDotP: float = _tag(3, "Dot", "Added mass")  # noqa: N815
    mDotQ: float = _tag(4, "Dot", "Added mass")  # noqa: N815
    nDotR: float = _tag(5, "Dot", "Added mass")  # noqa: N815
    without_coriolis: bool = tag(
        "disable_coriolis",
        default=False,
        doc="Whether the added mass causes no Coriolis and centripetal forces.",
    )
    without_added_mass: bool = tag(
        "disable_added_mass", default=False, doc="Whether the added mass resists no acceleration."
    )
    current: tuple[float, float, float] = tag(
        "default_current",
        default=(0.0, 0.0, 0.0),
        unit="m/s",
        doc="Initial velocity of the water in the world.",
    )
    namespace: str = tag(
        "namespace",
        default="",
        doc="If set, the velocity of the water (Vector3) is received on "
        "`/model/<namespace>/ocean_current` instead of `/ocean_current`.",
    )
    water_density: float = tag("water_density", default=998.0, unit="kg/m³", doc="No effect.")


class HydrodynamicsSystem(Plugin[HydrodynamicsParameters]):
    """Applies the damping of water to a link, and the inertia of the water that moves with it.

    The tags follow the convention of SNAME: the force (``x``, ``y``, ``z``) or torque (``k``,
    ``m``, ``n``), and the velocities (``U``, ``V``, ``W``) or turn rates (``P``, ``Q``, ``R``) that
    cause it. The products of different axes, such as ``<nV>``, ``<yVabsR>``, ``<xRQ>`` and
    ``<yDotR>``, are supported as well. Damping and added mass are computed implicitly, so they are
    stable at each time step. The ``<fluid_added_mass>`` of the link's ``<inertial>`` is added to
    that of the tags; it also acts without this plugin. Original plugin: ``Hydrodynamics`` in
    gz-sim.
    """

    filenames: ClassVar[tuple[str, ...]] = ("gz-sim-hydrodynamics-system",)

    def read_tags(self, cls: type[T], element: Element, *, ignore: Iterable[str] = ()) -> T:
        return super().read_tags(cls, element, ignore=(*ignore, *_COEFFICIENTS))

    def configure(self) -> None:
        config = self.config
        added = -self._matrix("Dot")
        if config.without_added_mass:
            added = np.zeros((6, 6))
        link = self.part.description.link(config.link.strip())
        # Two forces that resist one acceleration would have to be solved together.
        stated = _stated_mass(link)
        namespace = config.namespace.strip()
        topic = f"model/{namespace}/ocean_current" if namespace else "ocean_current"
        # Without a namespace, all models are in the same current.
        scope = self.scope if namespace else replace(self.scope, common=True)
        self.add(
            Hydrodynamics(
                scope,
                HydrodynamicsConfig(
                    link=config.link.strip(),
                    linear=self._matrix(""),
                    quadratic=self._products("abs"),
                    square=self._products(""),
                    added_mass=(added + added.T) / 2 + stated,
                    coriolis=not config.without_coriolis or bool(stated.any()),
                    current=config.current,
                    current_topic=gz_name(self, topic, ""),
                ),
            )
        )

    @classmethod
    def of_inertials(cls, part: Part, shared: Shared) -> Iterator[Hydrodynamics]:
        """Creates the forces of each ``<fluid_added_mass>``, unless a plugin of its link does."""
        names = set(map(short_name, cls.filenames))
        served = {
            stated.text.strip()
            for plugin in part.description.plugins
            if short_name(plugin.filename) in names
            and (stated := plugin.element.find("link_name")) is not None
        }
        none = np.zeros((6, 6))
        for link in part.description.links:
            mass = _stated_mass(link)
            if part.description.static or link.name in served or not mass.any():
                continue
            assert link.inertial is not None
            scope = Scope(
                part=part,
                shared=shared,
                node=f"{part.name}/{link.name}/fluid_added_mass",
                title=f'added mass of link "{link.name}"',
                origin=link.inertial.origin,
            )
            config = HydrodynamicsConfig(
                link=link.name,
                linear=none,
                quadratic=np.zeros((6, 6, 6)),
                square=np.zeros((6, 6, 6)),
                added_mass=mass,
                coriolis=True,
                current=(0.0, 0.0, 0.0),
                current_topic="",
            )
            yield part.made(partial(Hydrodynamics, scope, config))

    def _matrix(self, infix: str) -> Array:
        """Coefficients by force and velocity, shape (6, 6)."""
        return np.array(
            [
                [self._coefficient(f"{force}{infix}{velocity}") for velocity in _VELOCITIES]
                for force in _FORCES
            ]
        )

    def _products(self, infix: str) -> Array:
        """Coefficients by force and two velocities, shape (6, 6, 6)."""
        return np.array(
            [
                [
                    [self._coefficient(f"{force}{one}{infix}{other}") for other in _VELOCITIES]
                    for one in _VELOCITIES
                ]
                for force in _FORCES
            ]
        )

    def _coefficient(self, name: str) -> float:
        return number_at(self.tag.element, name)
