"""Limits of a drive's commands."""

import math

import pytest

from cartwheel.codes import devices
from cartwheel.devices.drives.limiter import limited
from cartwheel.dialects.ros_control.controllers.limits import read_limits
from cartwheel.dialects.ros_control.settings import Settings
from cartwheel.errors import PluginError


def test_velocity_and_acceleration():
    values = {
        "has_velocity_limits": True,
        "max_velocity": 1.0,
        "min_velocity": -0.5,
        "has_acceleration_limits": True,
        "max_acceleration": 2.0,
    }
    limits = read_limits(Settings(values, "c"))
    assert limited(limits, 5.0, 0.0, 0.0, 0.1) == pytest.approx(0.2)
    assert limited(limits, 5.0, 0.95, 0.95, 0.1) == 1.0
    assert limited(limits, -5.0, -0.45, -0.45, 0.1) == -0.5


def test_a_limit_that_is_switched_off_does_nothing():
    values = {"has_velocity_limits": False, "max_velocity": 1.0}
    assert limited(read_limits(Settings(values, "c")), 5.0, 0.0, 0.0, 0.1) == 5.0


def test_what_ros2_leaves_open_is_no_limit():
    """Its files write .NAN for it; the limit of a pair that is stated counts for both."""
    names = ("max_jerk", "min_jerk", "max_deceleration", "min_velocity")
    values = {"max_velocity": 1.0, "max_acceleration": 2.0, **dict.fromkeys(names, math.nan)}
    limits = read_limits(Settings(values, "c"))
    assert limited(limits, 5.0, 0.0, 0.0, 0.1) == pytest.approx(0.2)
    assert limited(limits, 0.0, 0.5, 0.5, 0.1) == pytest.approx(0.3)
    assert limited(limits, -5.0, -0.95, -0.95, 0.1) == -1.0


def test_jerk_limits_how_the_acceleration_grows():
    """By j dt in each dt: from rest the speeds grow as 2 j dt² times 1, 3, 6, 10 ..."""
    limits = read_limits(Settings({"has_jerk_limits": True, "max_jerk": 3.0}, "c"))
    dt, speeds = 0.1, [0.0, 0.0]
    for _ in range(4):
        speeds.append(limited(limits, 100.0, speeds[-1], speeds[-2], dt))
    step = 2 * 3.0 * dt * dt
    assert speeds[2:] == pytest.approx([step * n for n in (1, 3, 6, 10)])


def test_ros2_slows_by_a_limit_of_its_own():
    values = {"max_acceleration": 1.0, "max_deceleration": -4.0}
    limits = read_limits(Settings(values, "c"))
    assert limited(limits, 5.0, 1.0, 1.0, 0.1) == pytest.approx(1.1)
    assert limited(limits, 0.0, 1.0, 1.0, 0.1) == pytest.approx(0.6)


@pytest.mark.parametrize(
    ("values", "code"),
    [
        ({"has_velocity_limits": True}, devices.CONTROLLER_PARAMETER_MISSING),
        ({"max_velocity": 1.0, "min_velocity": 2.0}, devices.PLUGIN_RANGE_REVERSED),
    ],
)
def test_limits_that_make_no_sense(values, code):
    with pytest.raises(PluginError) as caught:
        read_limits(Settings(values, "c"))
    assert caught.value.code is code


@pytest.mark.parametrize(
    ("parameters", "stops"),
    [
        ({"max_jerk": 0.0, "min_jerk": 0.0}, False),
        ({"max_jerk": 0.0, "has_jerk_limits": True}, True),
        ({"max_acceleration": 0.0}, False),
        ({"max_velocity": 0.0}, True),
    ],
)
def test_a_limit_of_zero_that_would_let_nothing_move_is_none(parameters, stops):
    limits = read_limits(Settings(parameters, "c"))
    assert (limited(limits, 1.0, 0.0, 0.0, 0.1) == 0.0) == stops
