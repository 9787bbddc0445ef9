"""The orientation that is estimated from a faulty accelerometer."""

import math

import numpy as np
import pytest

from cartwheel.devices.inertial.imu import orientation_error
from cartwheel.geometry import quat_normalize, rotate, yaw_of

G = 9.8


def test_a_bias_tilts_the_vertical_by_its_ratio_to_gravity():
    """The measured vertical is (x, y, g), which the error must turn upright, to second order."""
    x, y = 0.03, -0.05
    error = quat_normalize(orientation_error(0.0, x, y, G))
    up = rotate(error, (x / G, y / G, 1.0))
    assert up[:2] == pytest.approx((0.0, 0.0), abs=(0.06 / G) ** 2)


def test_a_yaw_error_turns_about_the_vertical():
    error = orientation_error(0.4, 0.0, 0.0, G)
    assert yaw_of(error) == pytest.approx(0.4)
    assert error[:2] == (0.0, 0.0)


def test_without_gravity_nothing_is_tilted():
    assert orientation_error(0.0, 0.2, 0.3, math.inf) == (0.0, 0.0, 0.0, 1.0)


def test_errors_of_arrays_have_the_bits_of_those_of_floats():
    values = np.random.default_rng(1).normal(0.0, 0.5, (3, 50))
    together = np.array(orientation_error(*values, G)).T.tolist()
    assert together == [list(orientation_error(*each, G)) for each in values.T.tolist()]
