"""Latitude, longitude and height of positions in the world, on the ellipsoid WGS 84."""

from __future__ import annotations

import math
from dataclasses import dataclass

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

    def locate_degrees(self, place: Vec3) -> Vec3:
        """Returns latitude and longitude in degrees and height in m of a position in the world."""
        latitude, longitude, height = self.locate(place)
        return math.degrees(latitude), math.degrees(longitude), height

    def geographic(self, vector: Vec3) -> Vec3:
        """Converts a vector from the world frame to east, north and up."""
        return self.east_north(vector)


@dataclass(frozen=True, kw_only=True, slots=True)
class FlatDatum:
    """Position and heading of a world's origin on an Earth that is flat around the origin.

    Within a few kilometres, the error is below 1 m.
    """

    latitude: float
    """Degrees."""
    longitude: float
    """Degrees."""
    height: float
    """m above the ellipsoid."""
    heading: float
    """Angle of the world's x axis, clockwise from north, rad. At 0, y points west."""

    def locate_degrees(self, place: Vec3) -> Vec3:
        """Returns latitude and longitude in degrees and height in m of a position in the world."""
        north, west, up = self.geographic(place)
        to_north, to_east = radii(math.radians(self.latitude))
        return (
            self.latitude + math.degrees(north / to_north),
            self.longitude - math.degrees(west / to_east),
            self.height + up,
        )

    def geographic(self, vector: Vec3) -> Vec3:
        """Converts a vector from the world frame to north, west and up."""
        x, y, z = vector
        cos, sin = math.cos(self.heading), math.sin(self.heading)
        return cos * x + sin * y, cos * y - sin * x, z


def radii(latitude: float) -> tuple[float, float]:
    """Returns the distances per rad of latitude and of longitude, m, at a latitude in rad."""
    sin = math.sin(latitude)
    bend = 1 / (1 - ECCENTRICITY2 * sin * sin)
    across = EQUATOR * math.sqrt(bend)
    return across * (1 - ECCENTRICITY2) * bend, across * math.cos(latitude)
