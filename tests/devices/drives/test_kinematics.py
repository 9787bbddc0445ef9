"""Wheel speeds and paths against the geometry of circles."""

import math

import numpy as np
import pytest

from cartwheel.devices.drives.kinematics import along_arc, axle_motion, rim_speeds
from cartwheel.devices.ramp import ramp


def test_each_wheel_rolls_on_its_own_circle():
    """At 0.6 m/s and 1.2 rad/s, the middle's radius is 0.5 m, and the wheels' 0.3 m and 0.7 m."""
    left, right = rim_speeds(0.6, 1.2, 0.4)
    assert left == pytest.approx(1.2 * 0.3)
    assert right == pytest.approx(1.2 * 0.7)


def test_the_motion_of_an_axle_is_the_inverse_of_its_wheels_speeds():
    assert axle_motion(*rim_speeds(0.6, 1.2, 0.4), 0.4) == pytest.approx((0.6, 1.2))
    assert axle_motion(*rim_speeds(-0.3, -0.5, 1.1), 1.1) == pytest.approx((-0.3, -0.5))


@pytest.mark.parametrize("turn", [math.pi / 2, -math.pi / 2, 0.3, 1e-6])
def test_an_arc_ends_on_its_circle(turn):
    """A circle of radius r around (0, r): after the angle t, x = r sin t and y = r (1 - cos t)."""
    way = 0.8
    radius = way / turn
    x, y, heading = along_arc((0.0, 0.0, 0.0), way, turn)
    # The reference loses digits by 1 - cos t, so its error is relative to the radius.
    assert x == pytest.approx(radius * math.sin(turn), abs=1e-15 * abs(radius))
    assert y == pytest.approx(radius * (1 - math.cos(turn)), abs=1e-15 * abs(radius))
    assert heading == turn


def test_a_motion_without_rotation_is_a_straight_line():
    x, y, heading = along_arc((1.0, 2.0, math.pi / 2), 0.5, 0.0, sideways=0.25)
    assert (x, y, heading) == pytest.approx((0.75, 2.5, math.pi / 2))


def test_arcs_one_after_the_other_close_a_circle():
    pose = (0.0, 0.0, 0.0)
    for _ in range(12):
        pose = along_arc(pose, 0.1, math.pi / 6, sideways=0.05)
    assert pose == pytest.approx((0.0, 0.0, 2 * math.pi), abs=1e-12)


def test_many_robots_move_with_the_bits_of_one():
    rng = np.random.default_rng(2)
    pose, (way, turn, sideways) = rng.normal(size=(3, 50)), rng.normal(size=(3, 50))
    turn[:5] = 0.0
    many = np.array(along_arc(tuple(pose), way, turn, sideways=sideways))
    for i in range(50):
        one = along_arc(tuple(pose[:, i].tolist()), way[i], turn[i], sideways=sideways[i])
        assert many[:, i].tobytes() == np.array(one).tobytes()


def test_a_ramp_ends_at_its_target():
    value, speeds = 0.0, []
    for _ in range(4):
        value = ramp(value, 0.25, 0.1)
        speeds.append(value)
    assert speeds == pytest.approx([0.1, 0.2, 0.25, 0.25])
    assert ramp(0.0, -1.0, 0.1) == pytest.approx(-0.1)
    assert ramp(np.array([0.0, 0.2]), np.array([1.0, 0.25]), 0.1).tolist() == [0.1, 0.25]
