"""Places on the Earth: from the axes of a world to latitude, longitude and height (WGS 84)."""

from __future__ import annotations

import math
from dataclasses import dataclass

from cartwheel.description.model import Element
from cartwheel.geometry import Vec3
from cartwheel.plugins.parameters import number as stated

EQUATOR = 6378137.0
"""m, the ellipsoid's larger half axis."""
FLATTENING = 1 / 298.257223563
ECCENTRICITY2 = FLATTENING * (2 - FLATTENING)


def to_earth(latitude: float, longitude: float, height: float) -> Vec3:
    """Earth-centred coordinates in m of a place in rad, rad and m above the ellipsoid."""
    sin, cos = math.sin(latitude), math.cos(latitude)
    across = EQUATOR / math.sqrt(1 - ECCENTRICITY2 * sin * sin)
    return (
        (across + height) * cos * math.cos(longitude),
        (across + height) * cos * math.sin(longitude),
        (across * (1 - ECCENTRICITY2) + height) * sin,
    )


def from_earth(x: float, y: float, z: float) -> Vec3:
    """Latitude and longitude in rad and height in m; the inverse of `to_earth`."""
    distance = math.hypot(x, y)
    latitude = math.atan2(z, distance * (1 - ECCENTRICITY2))
    for _ in range(6):
        sin = math.sin(latitude)
        across = EQUATOR / math.sqrt(1 - ECCENTRICITY2 * sin * sin)
        latitude = math.atan2(z + ECCENTRICITY2 * across * sin, distance)
    sin, cos = math.sin(latitude), math.cos(latitude)
    across = EQUATOR / math.sqrt(1 - ECCENTRICITY2 * sin * sin)
    # Along the normal: good at the poles as well.
    height = distance * cos + z * sin - across * (1 - ECCENTRICITY2 * sin * sin)
    return latitude, math.atan2(y, x), height


@dataclass(frozen=True, kw_only=True, slots=True)
class Datum:
    """Where a world's origin lies, and how its axes are turned."""

    latitude: float = 0.0
    longitude: float = 0.0
    """rad."""
    height: float = 0.0
    """m."""
    heading: float = 0.0
    """rad by which the world's x axis is turned from the east towards the north."""

    def east_north(self, vector: Vec3) -> Vec3:
        """A vector of the world along east, north and up."""
        x, y, z = vector
        cos, sin = math.cos(self.heading), math.sin(self.heading)
        return cos * x - sin * y, sin * x + cos * y, z

    def locate(self, place: Vec3) -> Vec3:
        """Latitude and longitude in rad and height in m of a place in the world."""
        east, north, up = self.east_north(place)
        sin_lat, cos_lat = math.sin(self.latitude), math.cos(self.latitude)
        sin_lon, cos_lon = math.sin(self.longitude), math.cos(self.longitude)
        x, y, z = to_earth(self.latitude, self.longitude, self.height)
        outwards = cos_lat * up - sin_lat * north
        return from_earth(
            x - sin_lon * east + cos_lon * outwards,
            y + cos_lon * east + sin_lon * outwards,
            z + cos_lat * north + sin_lat * up,
        )


def world_datum(spherical: Element | None) -> Datum | None:
    """The origin that a world's ``<spherical_coordinates>`` states; None where it states none.

    Raises:
        PluginError: A number that is none.
    """
    if spherical is None:
        return None

    def number(name: str) -> float:
        child = spherical.find(name)
        return stated(child) if child is not None else 0.0

    return Datum(
        latitude=math.radians(number("latitude_deg")),
        longitude=math.radians(number("longitude_deg")),
        height=number("elevation"),
        heading=math.radians(number("heading_deg")),
    )
