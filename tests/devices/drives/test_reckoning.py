"""Dead reckoning: poses and velocities."""

import math
from types import SimpleNamespace

import pytest

from cartwheel.devices.drives.reckoning import AxleReckoning, DeadReckoning


def test_a_pose_and_a_velocity_follow_from_motions():
    reckoning = DeadReckoning()
    reckoning.go(0.5, 0.0, 0.1)
    reckoning.go(0.0, math.pi / 2, 0.5)
    reckoning.go(0.2, 0.0, 0.1, sideways=-0.1)
    position, orientation, linear, angular = reckoning.motion()
    assert position == pytest.approx((0.6, 0.2, 0.0))
    assert orientation == pytest.approx((0.0, 0.0, math.sin(math.pi / 4), math.cos(math.pi / 4)))
    assert linear == pytest.approx((2.0, -1.0, 0.0))
    assert angular == (0.0, 0.0, 0.0)


def test_a_motion_without_a_duration_keeps_the_velocity():
    reckoning = DeadReckoning()
    reckoning.go(0.5, 0.1, 0.1)
    reckoning.go(0.5, 0.1, 0.0)
    linear, angular = reckoning.motion()[2:]
    assert linear == pytest.approx((5.0, 0.0, 0.0))
    assert angular == pytest.approx((0.0, 0.0, 1.0))


def test_the_velocity_is_the_mean_of_the_last_motions():
    reckoning = DeadReckoning(window=2)
    assert reckoning.motion()[2] == (0.0, 0.0, 0.0)
    for way in (0.9, 0.1, 0.3):
        reckoning.go(way, way, 0.1)
    linear, angular = reckoning.motion()[2:]
    assert linear == pytest.approx((2.0, 0.0, 0.0))
    assert angular == pytest.approx((0.0, 0.0, 2.0))
    reckoning.restart()
    assert reckoning.motion() == (
        (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    )  # fmt: skip


def test_an_axle_measures_from_its_first_reading():
    left, right = SimpleNamespace(position=3.0), SimpleNamespace(position=-2.0)
    reckoning = AxleReckoning(left, right, radius=0.1, separation=0.4)
    reckoning.read(0.1)
    assert reckoning.pose == (0.0, 0.0, 0.0)
    left.position += 1.0
    right.position += 3.0
    reckoning.read(0.1)
    # The wheels roll 0.1 m and 0.3 m: 0.2 m in the middle, and (0.3 - 0.1) / 0.4 rad.
    _, _, heading = reckoning.pose
    assert heading == pytest.approx(0.5)
    assert reckoning.motion()[2][0] == pytest.approx(2.0)
    reckoning.begin()
    left.position += 9.0
    reckoning.read(0.1)
    assert reckoning.pose == (0.0, 0.0, 0.0)


def test_the_estimate_does_not_depend_on_when_it_is_read():
    often, once = DeadReckoning(window=3), DeadReckoning(window=3)
    for index in range(1000):
        motion = 0.01 * math.sin(index), 0.1 * math.cos(0.3 * index), 0.005 * (index % 7 > 0)
        for reckoning in (often, once):
            reckoning.go(*motion, sideways=0.001 * index)
        often.motion()
    assert often.pose[0] != 0.0
    assert often.motion() == once.motion()
