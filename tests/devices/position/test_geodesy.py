"""Latitude, longitude and height."""

import math

import pytest

from cartwheel.devices.position.geodesy import (
    EQUATOR,
    FLATTENING,
    Datum,
    FlatDatum,
    from_earth,
    radii,
    to_earth,
)


def test_poles_and_equator_lie_where_the_ellipsoid_has_them():
    assert to_earth(0, 0, 0) == pytest.approx((EQUATOR, 0, 0))
    assert to_earth(0, math.pi / 2, 100) == pytest.approx((0, EQUATOR + 100, 0), abs=1e-6)
    pole = EQUATOR * (1 - FLATTENING)
    assert to_earth(math.pi / 2, 0, 0) == pytest.approx((0, 0, pole), abs=1e-6)


@pytest.mark.parametrize("latitude", [-89.9, -60.0, -1.0, 0.0, 33.3, 52.5, 90.0])
@pytest.mark.parametrize("height", [-100.0, 0.0, 8848.0])
def test_there_and_back_is_where_it_began(latitude, height):
    place = (math.radians(latitude), math.radians(13.4), height)
    again = from_earth(*to_earth(*place))
    assert again[0] == pytest.approx(place[0], abs=1e-12)
    assert again[2] == pytest.approx(height, abs=1e-6)


def test_a_way_north_is_an_arc_of_the_meridian():
    """m(φ) = a (1 - e²) / (1 - e² sin²φ)^1.5 is the meridian's radius of curvature."""
    latitude = math.radians(50.0)
    e2 = FLATTENING * (2 - FLATTENING)
    radius = EQUATOR * (1 - e2) / (1 - e2 * math.sin(latitude) ** 2) ** 1.5
    across = EQUATOR / math.sqrt(1 - e2 * math.sin(latitude) ** 2)
    datum = Datum(latitude=latitude, longitude=0.2)
    north = datum.locate((0.0, 100.0, 0.0))
    assert north[0] - latitude == pytest.approx(100 / radius, rel=1e-5)
    east = datum.locate((100.0, 0.0, 0.0))
    assert east[1] - 0.2 == pytest.approx(100 / (across * math.cos(latitude)), rel=1e-5)
    # A plane leaves the Earth by d²/2R.
    assert north[2] == pytest.approx(100**2 / 2 / radius, rel=1e-3)
    turned = Datum(latitude=latitude, longitude=0.2, heading=math.pi / 2)
    assert turned.locate((100.0, 0.0, 0.0)) == pytest.approx(north)


@pytest.mark.parametrize("latitude", [-60.0, 0.0, 49.9])
def test_near_its_origin_the_earth_is_flat(latitude):
    """A flat Earth is wrong by up to 2 d² / R in the plane and d² / 2R upward.

    The plane's error is the convergence of the meridians, d² tan(latitude) / R; tan 60° < 2.
    """
    flat = FlatDatum(latitude=latitude, longitude=8.9, height=120.0, heading=0.0)
    exact = Datum(
        latitude=math.radians(latitude),
        longitude=math.radians(8.9),
        height=120.0,
        heading=math.pi / 2,
    )
    to_north, to_east = radii(math.radians(latitude))
    x, y = 800.0, -600.0
    bent = 1000.0**2 / EQUATOR
    one, two = flat.locate_degrees((x, y, 3.0)), exact.locate_degrees((x, y, 3.0))
    assert math.radians(one[0] - two[0]) * to_north == pytest.approx(0.0, abs=2 * bent)
    assert math.radians(one[1] - two[1]) * to_east == pytest.approx(0.0, abs=2 * bent)
    assert two[2] - one[2] == pytest.approx(bent / 2, rel=0.01)


def test_a_heading_turns_the_axes_clockwise_from_north():
    east = FlatDatum(latitude=0.0, longitude=0.0, height=0.0, heading=math.pi / 2)
    # The x axis points east, so a velocity along it has no northern and a negative western part.
    assert east.geographic((2.0, 0.0, 1.0)) == pytest.approx((0.0, -2.0, 1.0))
