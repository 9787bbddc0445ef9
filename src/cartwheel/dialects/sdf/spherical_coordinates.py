"""SDF's ``<spherical_coordinates>`` element."""

from __future__ import annotations

import math

from cartwheel.description.model import Element
from cartwheel.devices.position.geodesy import Datum
from cartwheel.dialects.tags import number


def read_datum(spherical: Element | None) -> Datum | None:
    """Returns the origin of a world's ``<spherical_coordinates>``, or None without them.

    Raises:
        PluginError: A value is not a number.
    """
    if spherical is None:
        return None

    def stated(name: str) -> float:
        child = spherical.find(name)
        return number(child) if child is not None else 0.0

    return Datum(
        latitude=math.radians(stated("latitude_deg")),
        longitude=math.radians(stated("longitude_deg")),
        height=stated("elevation"),
        heading=math.radians(stated("heading_deg")),
    )
