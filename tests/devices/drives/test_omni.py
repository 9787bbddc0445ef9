"""Omni wheels: their formulas, and the motion that they estimate."""

import math

import pytest
from tests.devices.drives.joints import Joint

from cartwheel.devices.drives.omni import (
    OmniWheels,
    OmniWheelsConfig,
    omni_motion,
    omni_rim_speeds,
    wheel_places,
)
from cartwheel.devices.drives.reckoning import DeadReckoning

REACH = 0.25
MOTIONS = [(0.3, 0.0, 0.0), (0.0, 0.3, 0.0), (0.0, 0.0, 0.6), (0.2, -0.1, 0.4)]


@pytest.mark.parametrize("count", [3, 4, 6])
@pytest.mark.parametrize("motion", MOTIONS)
def test_the_wheels_of_a_motion_give_that_motion(motion, count):
    places = wheel_places(count, 0.3)
    speeds = omni_rim_speeds(places, *motion, REACH)
    assert omni_motion(places, speeds, REACH) == pytest.approx(motion, abs=1e-15)


def test_each_wheel_rolls_across_its_direction():
    """A wheel ahead does not roll forward; its axis points ahead, so it rolls to the right."""
    ahead, left, back, right = omni_rim_speeds(wheel_places(4, 0.0), 0.3, 0.0, 0.0, REACH)
    assert (ahead, left, back, right) == pytest.approx((0.0, 0.3, 0.0, -0.3))
    assert omni_rim_speeds((0.0,), 0.0, 0.3, 0.0, REACH) == pytest.approx((-0.3,))
    assert omni_rim_speeds((1.2,), 0.0, 0.0, 1.0, REACH) == pytest.approx((-REACH,))


def test_a_wheel_that_slips_is_averaged():
    """With four wheels, the motion is the one with the least squares of the differences."""
    places = wheel_places(4, 0.0)
    ahead, left, back, right = omni_rim_speeds(places, 0.3, 0.0, 0.0, REACH)
    forward, sideways, turn = omni_motion(places, (ahead, left + 0.1, back, right), REACH)
    assert forward == pytest.approx(0.35)
    assert sideways == pytest.approx(0.0, abs=1e-15)
    assert turn == pytest.approx(-0.1 / 4 / REACH)


def made(measures):
    joints = [Joint() for _ in range(3)]
    reckoning = DeadReckoning()
    config = OmniWheelsConfig(radius=0.05, reach=REACH, offset=0.0, measures=measures)
    wheels = OmniWheels(config, joints, None, reckoning)
    wheels.restart()
    return wheels, joints, reckoning


@pytest.mark.parametrize("measures", ["positions", "velocities", "nothing"])
def test_the_estimate_follows_an_arc(measures):
    """Sideways at 0.2 m/s while turning at 0.8 rad/s: after a quarter, a chord of √2 v / w."""
    wheels, joints, reckoning = made(measures)
    steps = 100
    seconds = math.pi / 2 / 0.8 / steps
    for _ in range(steps):
        wheels.command((0.0, 0.2, 0.8))
        for joint in joints:
            joint.velocity = joint.command
            joint.position += joint.command * seconds
        wheels.measure(seconds)
    x, y, heading = reckoning.pose
    assert math.hypot(x, y) == pytest.approx(math.sqrt(2) * 0.2 / 0.8, rel=1e-9)
    assert (x < 0, y > 0) == (True, True)
    assert heading == pytest.approx(math.pi / 2)


def test_a_stop_holds_the_wheels():
    wheels, joints, _ = made("positions")
    wheels.command((0.1, 0.2, 0.3))
    assert all(joint.command for joint in joints)
    wheels.stop()
    assert [joint.command for joint in joints] == [0.0, 0.0, 0.0]
