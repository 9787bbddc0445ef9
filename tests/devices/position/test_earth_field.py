"""The Earth's magnetic field, compared with the World Magnetic Model."""

import math

import pytest

from cartwheel.devices.position.earth_field import earth_field


@pytest.mark.parametrize(
    ("latitude", "longitude", "declination", "inclination", "microtesla"),
    [
        # Declination and inclination in degrees: published maps of the World Magnetic Model 2020.
        (47.4, 8.5, 3, 63, 48),
        (40, -100, 6, 67, 52),
        (-30, 30, -23, -62, 29),
        (0, 0, -5, -30, 32),
        (60, 100, 0, 78, 60),
        (-30, 150, 11, -61, 56),
    ],
)
def test_the_field_is_that_of_the_maps(latitude, longitude, declination, inclination, microtesla):
    east, north, up = earth_field(math.radians(latitude), math.radians(longitude))
    level = math.hypot(east, north)
    # The maps are rounded, and the terms above degree 5 change the field by about 1 %.
    assert math.degrees(math.atan2(east, north)) == pytest.approx(declination, abs=2.5)
    assert math.degrees(math.atan2(-up, level)) == pytest.approx(inclination, abs=2.5)
    assert 1e6 * math.hypot(level, up) == pytest.approx(microtesla, abs=1.8)


def test_the_field_continues_across_the_antimeridian():
    west = earth_field(0.5, -math.pi + 1e-6)
    east = earth_field(0.5, math.pi - 1e-6)
    assert west == pytest.approx(east, abs=1e-10)
