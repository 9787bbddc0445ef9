"""Limits of joints: the formulas, for floats and arrays."""

import math

import numpy as np
import pytest

from cartwheel.description.model import SoftLimits
from cartwheel.devices.joints.actuator import position_error
from cartwheel.devices.joints.limits import (
    JointLimits,
    limited_effort,
    limited_position,
    saturated,
    velocity_bounds,
)
from cartwheel.devices.joints.pid import DampedEffort

HARD = JointLimits(lower=-1.0, upper=2.0, velocity=3.0, effort=10.0)
SOFT = JointLimits(
    lower=-1.0,
    upper=2.0,
    velocity=3.0,
    effort=10.0,
    soft=SoftLimits(lower=-0.5, upper=1.5, k_position=4.0, k_velocity=20.0),
)


def test_the_speed_toward_a_soft_limit_decreases_with_the_distance():
    assert velocity_bounds(HARD, 1.4) == (-3.0, 3.0)
    assert velocity_bounds(SOFT, 0.5) == (-3.0, 3.0)
    assert velocity_bounds(SOFT, 1.25) == (-3.0, 4.0 * 0.25)
    # Beyond the soft limit, the joint must return.
    assert velocity_bounds(SOFT, 1.75) == (-3.0, -4.0 * 0.25)


def test_a_joint_without_position_limits_has_no_soft_limits():
    free = JointLimits(velocity=3.0, soft=SOFT.soft)
    assert velocity_bounds(free, 1.75) == (-3.0, 3.0)
    assert limited_position(free, 5.0, 1.75) == (5.0, 3.0)


def test_a_target_position_is_within_the_limits():
    assert limited_position(HARD, 5.0, 0.0) == (2.0, 3.0)
    assert limited_position(SOFT, 5.0, 1.25) == (1.5, 1.0)
    assert limited_position(SOFT, -5.0, 1.25) == (-0.5, 3.0)


@pytest.mark.parametrize(
    ("effort", "position", "velocity", "applies"),
    [
        (5.0, 2.1, 0.0, False),  # beyond the upper limit: not farther
        (-5.0, 2.1, 0.0, True),  # but back
        (-5.0, -1.1, 0.0, False),
        (5.0, 0.0, 3.1, False),  # too fast: not faster
        (-5.0, 0.0, 3.1, True),
        (1.0, 0.0, 3.1, True),  # 1 N m - 0.5 N m s/rad * 3.1 rad/s slows the joint
    ],
)
def test_beyond_a_limit_an_effort_only_moves_the_joint_back(effort, position, velocity, applies):
    command = DampedEffort(effort, 0.5)
    expected = command if applies else DampedEffort(0.0, 0.0)
    assert limited_effort(HARD, command, position, velocity) == expected


def test_an_effort_that_slows_a_joint_that_is_too_fast_is_limited_as_well():
    """-10 N m, with the damping: a constant effort would reverse this light joint."""
    effort, damping = limited_effort(HARD, DampedEffort(2.0, 10.0), 0.0, 4.0, gain=0.5)
    assert damping == 10.0
    assert effort - damping * 4.0 == pytest.approx(-10.0)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_limited_effort_is_constant_until_the_joint_is_fast_enough(sign):
    command = DampedEffort(sign * 50.0, 20.0)
    # 50 - 20 v exceeds 10 N m up to v = 2 rad/s, and is -10 N m at 3 rad/s.
    for velocity, expected in ((0.0, (10.0, 0.0)), (1.9, (10.0, 0.0)), (2.5, (50.0, 20.0))):
        effort, damping = saturated(command, 10.0, sign * velocity)
        assert (sign * effort, damping) == expected
    assert saturated(command, 10.0, sign * 4.0) == (sign * -10.0, 0.0)


def test_a_limited_effort_on_a_light_joint_keeps_the_damping():
    # 10 N m would accelerate the joint to 5 rad/s in one period, beyond the commanded 2.5 rad/s.
    effort, damping = saturated(DampedEffort(50.0, 20.0), 10.0, 1.0, gain=0.5)
    assert damping == 20.0
    assert effort - damping * 1.0 == pytest.approx(10.0)


def test_near_a_soft_limit_an_effort_is_a_damper_toward_the_velocity_bound():
    limited = limited_effort(SOFT, DampedEffort(10.0), 1.45, 0.1)
    # The bound is 4 (1.5 - 1.45) = 0.2 rad/s; 20 (0.2 - 0.1) = 2 N m are allowed.
    assert limited.effort == pytest.approx(20.0 * 0.2)
    assert limited.damping == 20.0
    assert limited.at(0.1) == pytest.approx(2.0)


def test_a_continuous_joint_takes_the_shorter_way():
    assert position_error(3.0, -3.0, continuous=False) == 6.0
    assert position_error(3.0, -3.0, continuous=True) == pytest.approx(6.0 - 2 * math.pi)


@pytest.mark.parametrize("limits", [HARD, SOFT])
def test_arrays_have_the_same_bits_as_floats(limits):
    generator = np.random.default_rng(5)
    efforts, damping, positions, velocities = generator.uniform(-4.0, 4.0, size=(4, 200)) * 1.7

    def results(effort, damped, position, velocity):
        limited = limited_effort(limits, DampedEffort(effort, damped), position, velocity)
        return (
            *limited_position(limits, effort, position),
            limited.effort,
            limited.damping,
            position_error(effort, position, continuous=True),
        )

    together = results(efforts, damping, positions, velocities)
    for index in range(200):
        inputs = (efforts, damping, positions, velocities)
        alone = results(*(float(each[index]) for each in inputs))
        assert [float(np.broadcast_to(each, 200)[index]) for each in together] == list(alone)
