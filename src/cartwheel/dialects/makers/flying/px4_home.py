"""The place of the world's origin on the Earth, for PX4's plugins."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from cartwheel.devices.position.geodesy import Datum
from cartwheel.dialects.sdf.spherical_coordinates import read_datum
from cartwheel.dialects.tags import tag
from cartwheel.simulation import Part

_HOME = Datum(latitude=math.radians(47.397742), longitude=math.radians(8.545594), height=488.0)
"""Irchel Park in Zurich, as in Gazebo."""


@dataclass(frozen=True, kw_only=True, slots=True)
class HomeTags:
    """The place of the world's origin, if the world has no ``<spherical_coordinates>``."""

    latitude: float = tag(
        "homeLatitude",
        default=47.397742,
        unit="degrees",
        least=-90.0,
        most=90.0,
        doc="Latitude of the world's origin, if the world has no `<spherical_coordinates>`.",
    )
    longitude: float = tag(
        "homeLongitude",
        default=8.545594,
        unit="degrees",
        least=-180.0,
        most=180.0,
        doc="Longitude of the world's origin, if the world has no `<spherical_coordinates>`.",
    )
    altitude: float = tag(
        "homeAltitude",
        default=488.0,
        unit="m",
        doc="Altitude of the world's origin, if the world has no `<spherical_coordinates>`.",
    )


def home_of(part: Part, tags: HomeTags | None = None) -> Datum:
    """Returns the place of the world's origin. The x axis points east.

    Args:
        part: The model's part of the simulation.
        tags: Tags of the plugin, if it has these tags.

    Raises:
        PluginError: The world's ``<spherical_coordinates>`` are invalid.
    """
    stated = read_datum(part.world.spherical_coordinates)
    if stated is not None:
        # As in Gazebo, the heading has no effect.
        return replace(stated, heading=0.0)
    if tags is None:
        return _HOME
    return Datum(
        latitude=math.radians(tags.latitude),
        longitude=math.radians(tags.longitude),
        height=tags.altitude,
    )
