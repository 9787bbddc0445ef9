"""What a vehicle in water weighs, and how much water it displaces."""

from __future__ import annotations

from dataclasses import dataclass

from cartwheel.description.meshes import MeshError
from cartwheel.description.model import Collision, Inertial, Link, PluginTag, RobotDescription
from cartwheel.description.sdf.links.inertia import WATER, volume_of
from cartwheel.dialects.catalogue import plugin_named, short_name
from cartwheel.dialects.world_plugins import BUILT_IN, WITHOUT_EFFECT

_THRUSTER = "gz-sim-thruster-system"
_IN_WATER = frozenset({_THRUSTER, "gz-sim-hydrodynamics-system"})
"""Plugins of vehicles in water."""
_LIFTING = frozenset({"gz-sim-buoyancy-engine-system", "BuoyancyPlugin"})
"""Plugins that add buoyancy."""
_HARMLESS = {*BUILT_IN, *WITHOUT_EFFECT}
_AIR = 100.0
"""Largest density of a fluid that is no water, kg/m³."""
_HEAVY = 0.2
"""Least part of the weight that water must not carry for a vehicle to sink. Less is an adjusted
buoyancy, which lets it sink or rise slowly."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Load:
    """The weight of a vehicle that sinks in water."""

    mass: float
    """kg."""
    displaced: float
    """Mass of the water that its collisions displace, kg."""
    unstated: tuple[str, ...]
    """Links without ``<inertial>``, which have SDF's default mass of 1 kg each."""


def is_in_water(description: RobotDescription) -> bool:
    """Whether a model has a plugin of vehicles in water."""
    return any(short_name(tag.filename) in _IN_WATER for tag in description.plugins)


def sinking_load(description: RobotDescription) -> Load | None:
    """The weight of a vehicle in water that is much heavier than the water that it displaces.

    As for gz-sim's Buoyancy, the collisions of all links displace water. None for other models, and
    if it is unknown what carries the model.
    """
    names = {short_name(tag.filename) for tag in description.plugins}
    if (
        description.static
        or not is_in_water(description)
        or not names.isdisjoint(_LIFTING)
        or not all(map(_is_known, description.plugins))
        or any(joint.parent == "world" for joint in description.joints)
        or _pushes_air(description)
    ):
        return None
    links = [link for link in description.links if link.inertial is not None and link.gravity]
    volumes = [_volume(each) for link in links for each in link.collisions]
    displaced = WATER * sum(volume or 0.0 for volume in volumes)
    mass = sum(link.inertial.mass for link in links if link.inertial is not None)
    if None in volumes or not displaced or mass - displaced < _HEAVY * mass:
        return None
    unstated = tuple(link.name for link in links if _is_default(link, link.inertial))
    return Load(mass=mass, displaced=displaced, unstated=unstated)


def _is_known(tag: PluginTag) -> bool:
    return plugin_named(tag.filename) is not None or short_name(tag.filename) in _HARMLESS


def _pushes_air(description: RobotDescription) -> bool:
    """Whether a thruster is a propeller in air."""
    for tag in description.plugins:
        density = tag.element.find("fluid_density")
        if short_name(tag.filename) == _THRUSTER and density is not None:
            try:
                return float(density.text) < _AIR
            except ValueError:
                return True
    return False


def _volume(collision: Collision) -> float | None:
    """The volume of a collision, m³; None if its mesh cannot be read."""
    try:
        return abs(volume_of(collision.shape)[0])
    except MeshError:
        return None


def _is_default(link: Link, inertial: Inertial | None) -> bool:
    """Whether an SDF link has no ``<inertial>``: then, its origin is that of the link."""
    return inertial is not None and inertial.mass == 1.0 and inertial.origin == link.origin
