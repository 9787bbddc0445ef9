"""The Earth's magnetic field at a place."""

from __future__ import annotations

import math

from cartwheel.devices.position.geodesy import to_earth
from cartwheel.geometry import Vec3

_RADIUS = 6371200.0
"""Reference radius of the model, m."""
_COEFFICIENTS = {
    (1, 0): (-29404.5, 0.0),
    (1, 1): (-1450.7, 4652.9),
    (2, 0): (-2500.0, 0.0),
    (2, 1): (2982.0, -2991.6),
    (2, 2): (1676.8, -734.8),
    (3, 0): (1363.9, 0.0),
    (3, 1): (-2381.0, -82.2),
    (3, 2): (1236.2, 241.8),
    (3, 3): (525.7, -542.9),
    (4, 0): (903.1, 0.0),
    (4, 1): (809.4, 282.0),
    (4, 2): (86.2, -158.4),
    (4, 3): (-309.4, 199.8),
    (4, 4): (47.9, -350.1),
    (5, 0): (-234.4, 0.0),
    (5, 1): (363.1, 47.7),
    (5, 2): (187.8, 208.4),
    (5, 3): (-140.7, -121.3),
    (5, 4): (-151.2, 32.2),
    (5, 5): (13.7, 99.1),
}
"""Coefficients g and h by degree and order, nT: the World Magnetic Model 2020 up to degree 5."""
_STEP = 1.0
"""Distance over which the potential is differentiated, m."""


def earth_field(latitude: float, longitude: float) -> Vec3:
    """Returns the Earth's magnetic field at sea level: east, north, up, T.

    The terms of the World Magnetic Model 2020 above degree 5 are omitted, which amount to about 1 %
    of the field.

    Args:
        latitude: rad.
        longitude: rad.
    """
    x, y, z = to_earth(latitude, longitude, 0.0)
    sin_lat, cos_lat = math.sin(latitude), math.cos(latitude)
    sin_lon, cos_lon = math.sin(longitude), math.cos(longitude)
    axes = (
        (-sin_lon, cos_lon, 0.0),
        (-sin_lat * cos_lon, -sin_lat * sin_lon, cos_lat),
        (cos_lat * cos_lon, cos_lat * sin_lon, sin_lat),
    )

    def along(axis: Vec3) -> float:
        ahead, behind = (
            _potential(x + side * axis[0], y + side * axis[1], z + side * axis[2])
            for side in (_STEP, -_STEP)
        )
        # The field is the negative gradient; nT become T.
        return (behind - ahead) / (2 * _STEP) * 1e-9

    east, north, up = (along(axis) for axis in axes)
    return east, north, up


def _potential(x: float, y: float, z: float) -> float:
    """Returns the magnetic potential at Earth-centred coordinates in m, nT m."""
    distance = math.sqrt(x * x + y * y + z * z)
    longitude = math.atan2(y, x)
    legendre = _legendre(z / distance)
    return _RADIUS * sum(
        (_RADIUS / distance) ** (degree + 1)
        * (g * math.cos(order * longitude) + h * math.sin(order * longitude))
        * legendre[degree, order]
        for (degree, order), (g, h) in _COEFFICIENTS.items()
    )


def _legendre(u: float) -> dict[tuple[int, int], float]:
    """Returns the Schmidt semi-normalized Legendre functions at the sine of a latitude."""
    most = max(degree for degree, _ in _COEFFICIENTS)
    across = math.sqrt(max(0.0, 1 - u * u))
    values = {(0, 0): 1.0}
    for order in range(most + 1):
        if order > 0:
            factor = math.sqrt((2 * order - 1) / (2 * order)) if order > 1 else 1.0
            values[order, order] = factor * across * values[order - 1, order - 1]
        for degree in range(order + 1, most + 1):
            before = values.get((degree - 2, order), 0.0)
            last = math.sqrt((degree - 1) ** 2 - order * order) * before
            scale = math.sqrt(degree * degree - order * order)
            values[degree, order] = (
                (2 * degree - 1) * u * values[degree - 1, order] - last
            ) / scale
    return values
