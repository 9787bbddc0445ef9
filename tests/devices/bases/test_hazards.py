"""Zones of bumpers, dropped wheels and reflected light."""

import math

import numpy as np
import pytest

from cartwheel.devices.bases.hazards import dropped, zone_at
from cartwheel.devices.bases.infrared import intensity


@pytest.mark.parametrize(
    ("degrees", "zone"),
    [
        (-80, "bump_right"),
        (-40, "bump_front_right"),
        (0, "bump_front_center"),
        (40, "bump_front_left"),
        (80, "bump_left"),
        (120, None),
        (-120, None),
    ],
)
def test_a_contact_presses_the_zone_in_its_direction(degrees, zone):
    angle = math.radians(degrees)
    assert zone_at(math.cos(angle), math.sin(angle)) == zone


def test_a_wheel_drops_above_one_bound_and_returns_below_another():
    assert not dropped(0.018, 0.02, before=False)
    assert dropped(0.0195, 0.02, before=False)
    assert dropped(0.018, 0.02, before=True)
    assert not dropped(0.014, 0.02, before=True)
    many = dropped(np.array([0.018, 0.018]), 0.02, before=np.array([False, True]))
    assert many.tolist() == [False, True]


def test_the_intensity_decreases_with_the_distance():
    assert intensity(0.0, 0.2) == 3500.0
    assert intensity(0.1, 0.2) == pytest.approx(3500.0 * math.exp(-math.e))
