"""Conversion of world positions to latitude, longitude and height (WGS 84)."""

from __future__ import annotations

import math
from dataclasses import dataclass

from cartwheel.description.model import Element
from cartwheel.dialects.tags import number as stated
from cartwheel.geometry import Vec3

EQUATOR = 6378137.0
"""Equatorial radius of the ellipsoid, m."""
FLATTENING = 1 / 298.257223563
ECCENTRICITY2 = FLATTENING * (2 - FLATTENING)


def to_earth(latitude: float, longitude: float, height: float) -> Vec3:
    """Returns Earth-centred coordinates in m; angles are in rad, the height is in m."""
    sin, cos = math.sin(latitude), math.cos(latitude)
    across = EQUATOR / math.sqrt(1 - ECCENTRICITY2 * sin * sin)
    return (
        (across + height) * cos * math.cos(longitude),
        (across + height) * cos * math.sin(longitude),
        (across * (1 - ECCENTRICITY2) + height) * sin,
    )


def from_earth(x: float, y: float, z: float) -> Vec3:
    """Returns latitude and longitude in rad and height in m; the inverse of `to_earth`."""
    distance = math.hypot(x, y)
    latitude = math.atan2(z, distance * (1 - ECCENTRICITY2))
    for _ in range(6):
        sin = math.sin(latitude)
        across = EQUATOR / math.sqrt(1 - ECCENTRICITY2 * sin * sin)
        latitude = math.atan2(z + ECCENTRICITY2 * across * sin, distance)
    sin, cos = math.sin(latitude), math.cos(latitude)
    across = EQUATOR / math.sqrt(1 - ECCENTRICITY2 * sin * sin)
    # Measured along the normal, which is also accurate at the poles.
    height = distance * cos + z * sin - across * (1 - ECCENTRICITY2 * sin * sin)
    return latitude, math.atan2(y, x), height


@dataclass(frozen=True, kw_only=True, slots=True)
class Datum:
    """Position and heading of a world's origin on the Earth."""

    latitude: float = 0.0
    longitude: float = 0.0
    """rad."""
    height: float = 0.0
    """m above the ellipsoid."""
    heading: float = 0.0
    """Angle of the world's x axis from east towards north, rad."""

    def east_north(self, vector: Vec3) -> Vec3:
        """Converts a vector from the world frame to east, north and up."""
        x, y, z = vector
        cos, sin = math.cos(self.heading), math.sin(self.heading)
        return cos * x - sin * y, sin * x + cos * y, z

    def locate(self, place: Vec3) -> Vec3:
        """Returns latitude and longitude in rad and height in m of a position in the world."""
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
    """Returns the origin of a world's ``<spherical_coordinates>``, or None without them.

    Raises:
        PluginError: A value is not a number.
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
