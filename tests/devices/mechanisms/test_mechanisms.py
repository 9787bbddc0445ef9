"""Arithmetic of elevators, winches and slipping wheels."""

import math

import numpy as np
import pytest

from cartwheel.devices.mechanisms.elevator import next_velocity
from cartwheel.devices.mechanisms.wheel_slip import compliance_factor, slip_of
from cartwheel.devices.mechanisms.winch import rope_end


@pytest.mark.parametrize(
    ("velocity", "distance", "expected"),
    [
        (0.0, 3.0, 0.02),  # 2 m/s² for 10 ms
        (1.49, 3.0, 1.5),  # the maximum speed
        (1.5, 0.25, 1.0),  # √(2 · 2 m/s² · 0.25 m)
        (-1.5, -0.25, -1.0),
    ],
)
def test_a_car_moves_as_fast_as_it_can_still_stop(velocity, distance, expected):
    assert next_velocity(velocity, distance, 1.5, 2.0, 100.0) == pytest.approx(expected)


def test_a_rope_ends_within_its_limits():
    assert rope_end(1.0, 1.0, (-0.5, 0.25), 0.125) == 1.125
    assert rope_end(1.2, 1.0, (-0.5, 0.25), 0.125) == 1.25
    assert rope_end(0.6, 1.0, (-0.5, 0.25), -0.5) == 0.5


def test_the_compliance_grows_with_the_rim_speed():
    assert compliance_factor(-4.0, 0.5, 8.0) == 0.25


def test_slip_is_an_angle_and_a_fraction_of_the_rim_speed():
    angle, fraction = slip_of(2.0, 1.0, 0.5, 1e-3)
    assert (angle, fraction) == (math.atan2(1.0, 1.5), 0.25)
    assert slip_of(5e-4, 1.0, 0.5, 1e-3) == (0.0, 0.0)
    assert slip_of(0.0, 1.0, 0.5, 1e-3) == (0.0, 0.0)


def test_many_mechanisms_have_the_bits_of_one():
    one, two, three = np.random.default_rng(5).normal(0, 1, (3, 100))
    one[0] = 0.0
    velocities = next_velocity(one, two, 1.5, 2.0, 100.0)
    ends = rope_end(one, two, (-0.5, 0.5), three)
    angles, fractions = slip_of(one, two, three, 0.1)
    for i, (a, b, c) in enumerate(zip(one.tolist(), two.tolist(), three.tolist(), strict=True)):
        assert velocities[i] == next_velocity(a, b, 1.5, 2.0, 100.0)
        assert ends[i] == rope_end(a, b, (-0.5, 0.5), c)
        assert (angles[i], fractions[i]) == slip_of(a, b, c, 0.1)
