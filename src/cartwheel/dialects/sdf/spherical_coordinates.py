"""SDF's ``<spherical_coordinates>`` element."""

from __future__ import annotations

import math

from cartwheel.description.model import Element
from cartwheel.devices.position.geodesy import Datum
from cartwheel.dialects.tags import number_at


def read_datum(spherical: Element | None) -> Datum | None:
    """Returns the origin of a world's ``<spherical_coordinates>``, or None without them.

    Raises:
        PluginError: A value is not a number.
    """
    if spherical is None:
        return None
    return Datum(
        latitude=math.radians(number_at(spherical, "latitude_deg")),
        longitude=math.radians(number_at(spherical, "longitude_deg")),
        height=number_at(spherical, "elevation"),
        heading=math.radians(number_at(spherical, "heading_deg")),
    )
