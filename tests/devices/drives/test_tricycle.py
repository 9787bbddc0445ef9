"""Ramps of a tricycle's wheel and steering."""

import math

import pytest

from cartwheel.devices.drives.tricycle import next_angle, next_speed


@pytest.mark.parametrize(
    ("speed", "target", "expected"),
    [(0.0, 4.0, 0.2), (3.9, 4.0, 4.0), (4.0, 1.0, 3.7), (-4.0, 1.0, -3.7), (-1.0, -4.0, -1.2)],
)
def test_a_wheel_gains_and_loses_speed_at_its_own_rates(speed, target, expected):
    """At 2 rad/s² and 3 rad/s², in 0.1 s."""
    limits = {"acceleration": 2.0, "deceleration": 3.0, "seconds": 0.1}
    assert next_speed(speed, target, **limits) == pytest.approx(expected)


def test_without_limits_a_target_is_reached_at_once():
    assert next_speed(0.0, 4.0, acceleration=0.0, deceleration=0.0, seconds=0.1) == 4.0
    assert next_angle(0.0, 0.6, rate=0.0, seconds=0.1) == 0.6


def test_steering_takes_its_time_and_ends_at_a_right_angle():
    assert next_angle(0.2, 0.6, rate=0.5, seconds=0.1) == pytest.approx(0.25)
    assert next_angle(0.0, -9.0, rate=0.0, seconds=0.1) == -math.pi / 2
