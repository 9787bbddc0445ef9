"""``gz-sim-buoyancy-system``: fluids in a world, in which its models float."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from cartwheel.component import Shared
from cartwheel.description.meshes import MeshError
from cartwheel.description.model import Collision, Element, Link, Mesh, PluginTag
from cartwheel.description.sdf.links.inertia import volume_of
from cartwheel.description.solids import solid_of
from cartwheel.devices.water.buoyancy import (
    Buoyancy,
    BuoyancyConfig,
    FloatingLinkConfig,
    FloatingShape,
    Fluid,
)
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import number_at, tag, vector
from cartwheel.errors import PluginError
from cartwheel.simulation import Part

_WATER = 1000.0
"""kg/m³."""


@dataclass(frozen=True, kw_only=True, slots=True)
class BuoyancyParameters:
    density: float = tag(
        "uniform_fluid_density",
        default=_WATER,
        unit="kg/m³",
        least=0.0,
        doc="Density of the fluid that fills the world.",
    )
    lowest: float = tag(
        "graded_buoyancy/default_density",
        default=_WATER,
        unit="kg/m³",
        least=0.0,
        doc="Density below the lowest surface.",
    )
    graded: str = tag(
        "graded_buoyancy",
        default="",
        nested=True,
        doc="Layers of fluids. Each `<density_change>` contains the height `<above_depth>` in m, "
        "above which the fluid has the density `<density>` in kg/m³.",
    )
    enabled: tuple[str, ...] = tag(
        "enable",
        default=(),
        doc="Model (`<model>`) or link (`<model>::<link>`) that floats. Repeat the tag for "
        "several. Default: all of them.",
    )


class BuoyancySystem(Plugin[BuoyancyParameters]):
    """Fills the world with a fluid or layers of fluids, in which its models float.

    The weight of the fluid that its collisions displace acts on each link. A collision that crosses
    a surface displaces the fluid below and above it. As in gz-sim, overlapping collisions count
    twice, and a mesh acts at the origin of its collision, unless it crosses a surface. Original
    plugin: ``Buoyancy`` in gz-sim.
    """

    filenames: ClassVar[tuple[str, ...]] = ("gz-sim-buoyancy-system",)
    for_world: ClassVar[bool] = True

    def configure(self) -> None:
        _fluid_of(self.tag.element)

    @classmethod
    def added_to(cls, part: Part, shared: Shared, tag: PluginTag) -> Iterator[Buoyancy]:
        """Creates the buoyancy of a model."""
        if part.description.static:
            return
        try:
            fluid = _fluid_of(tag.element)
        except PluginError:
            # The world reports it.
            return
        enabled = {each.text.strip() for each in tag.element.find_all("enable")}
        links = tuple(
            FloatingLinkConfig(link=link.name, shapes=shapes)
            for link in part.description.links
            if _is_enabled(part.name, link.name, enabled)
            and (shapes := tuple(_shapes(link, cut=bool(fluid.layers))))
        )
        if links:
            scope = cls._scope_on(part, shared, tag, "buoyancy", "buoyancy of")
            config = BuoyancyConfig(links=links, fluid=fluid)
            yield part.made(lambda: Buoyancy(scope, config))


@dataclass(frozen=True, kw_only=True, slots=True)
class ClassicBuoyancyParameters:
    density: float = tag(
        "fluid_density", default=999.1026, unit="kg/m³", least=0.0, doc="Density of the fluid."
    )
    links: tuple[str, ...] = tag(
        "link",
        default=(),
        nested=True,
        doc="`<center_of_volume>` in m and `<volume>` in m³ of the link with this `name`. Repeat "
        "the tag for several. Default: those of the collisions.",
    )


class ClassicBuoyancy(Plugin[ClassicBuoyancyParameters]):
    """Makes a model float in a fluid that fills the world.

    The weight of the fluid that its collisions displace acts on each link. Original plugin:
    ``BuoyancyPlugin`` in Gazebo Classic.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libBuoyancyPlugin.so",)

    def configure(self) -> None:
        stated = {
            each.attribute("name") or "": FloatingShape(
                volume=number_at(each, "volume"),
                centre=_point(each.find("center_of_volume")),
            )
            for each in self.tag.element.find_all("link")
        }
        links = []
        for link in self.part.description.links:
            own = stated.get(link.name)
            shapes = (own,) if own is not None else tuple(_shapes(link, cut=False))
            if shapes:
                links.append(FloatingLinkConfig(link=link.name, shapes=shapes))
        fluid = Fluid(density=self.config.density)
        self.add(Buoyancy(self.scope, BuoyancyConfig(links=tuple(links), fluid=fluid)))


def _point(element: Element | None) -> tuple[float, float, float]:
    if element is None:
        return 0.0, 0.0, 0.0
    x, y, z = vector(element, 3)
    return x, y, z


def _fluid_of(element: Element) -> Fluid:
    """Returns the fluids in a plugin's element.

    Raises:
        PluginError: A density or height is invalid.
    """
    graded = element.find("graded_buoyancy")
    if element.find("uniform_fluid_density") is not None or graded is None:
        return Fluid(density=number_at(element, "uniform_fluid_density", _WATER))
    layers = {
        number_at(each, "above_depth"): number_at(each, "density")
        for each in graded.find_all("density_change")
    }
    return Fluid(
        density=number_at(graded, "default_density", _WATER), layers=tuple(sorted(layers.items()))
    )


def _is_enabled(model: str, link: str, enabled: Collection[str]) -> bool:
    """Whether a link floats. The names of the links of a nested model begin with its name."""
    names = [model, *f"{model}::{link}".split("::")[1:]]
    scoped = {"::".join(names[: count + 1]) for count in range(len(names))}
    return not enabled or not scoped.isdisjoint(enabled)


def _shapes(link: Link, *, cut: bool) -> Iterator[FloatingShape]:
    if link.inertial is None:
        return
    for collision in link.collisions:
        try:
            volume, centre = volume_of(collision.shape)
        except MeshError:
            # The compilation of the model reports it.
            continue
        volume = abs(volume)
        if volume > 0:
            yield _shape(link, collision, volume, centre, cut=cut)


def _shape(
    link: Link, collision: Collision, volume: float, centre: tuple[float, ...], *, cut: bool
) -> FloatingShape:
    solid = solid_of(collision, link.name) if cut else None
    pose = collision.pose
    if isinstance(collision.shape, Mesh) and not cut:
        return FloatingShape(volume=volume, centre=pose.position)
    x, y, z = centre
    return FloatingShape(
        volume=volume,
        centre=pose.apply((x, y, z)),
        corners=np.asarray(solid.vertices[solid.faces]) if solid is not None else None,
    )
