"""Directions of a Kobuki's bumpers, and readings of its cliff sensors."""

import math

import numpy as np
import pytest

from cartwheel.devices.bases.kobuki import bumper_at, cliff_reading


@pytest.mark.parametrize(
    ("degrees", "side"),
    [(0, "center"), (29, "center"), (31, "left"), (-31, "right"), (89, "left"), (91, "")],
)
def test_a_contact_presses_the_bumper_in_its_direction(degrees, side):
    heading = 3.0
    angle = heading + math.radians(degrees)
    normal = -np.array([math.cos(angle), math.sin(angle), 0.0])
    assert bumper_at(normal, heading) == side


def test_the_reading_falls_with_the_distance_and_is_limited():
    assert cliff_reading(0.0) == 4095
    assert cliff_reading(0.1) == int(76123 * math.atan2(0.995, 100))
