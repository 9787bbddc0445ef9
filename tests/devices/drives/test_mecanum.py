"""Mecanum wheels: their formulas, and the motion that they estimate."""

import math

import numpy as np
import pytest
from tests.devices.drives.joints import Joint

from cartwheel.devices.drives.limiter import Limits
from cartwheel.devices.drives.mecanum import (
    MecanumWheels,
    MecanumWheelsConfig,
    at_base,
    at_center,
    wheel_speeds,
    wheels_motion,
)
from cartwheel.devices.drives.reckoning import DeadReckoning

REACH = 0.45
MOTIONS = [(0.3, 0.0, 0.0), (0.0, 0.3, 0.0), (0.0, 0.0, 0.6), (0.2, -0.1, 0.4)]


@pytest.mark.parametrize("motion", MOTIONS)
def test_the_wheels_of_a_motion_give_that_motion(motion):
    assert wheels_motion(wheel_speeds(*motion, REACH), REACH) == pytest.approx(motion, abs=1e-15)


def test_each_wheel_rolls_as_its_rollers_let_it():
    """To the left, front left and back right wheels roll back; turning left, left wheels do."""
    assert wheel_speeds(0.3, 0.0, 0.0, REACH) == (0.3, 0.3, 0.3, 0.3)
    assert wheel_speeds(0.0, 0.3, 0.0, REACH) == (-0.3, 0.3, 0.3, -0.3)
    assert wheel_speeds(0.0, 0.0, 1.0, REACH) == (-REACH, REACH, -REACH, REACH)


def test_an_offset_base_frame_moves_about_the_centre():
    """A base frame 0.2 m ahead of the centre, turned by 90°, goes sideways as the robot turns."""
    offset = (0.2, 0.0, math.pi / 2)
    assert at_base((0.0, 0.0, 1.0), offset) == pytest.approx((0.2, 0.0, 1.0))
    assert at_center((0.2, 0.0, 1.0), offset) == pytest.approx((0.0, 0.0, 1.0))


@pytest.mark.parametrize("motion", MOTIONS)
def test_the_motion_of_the_base_frame_returns_from_the_centre(motion):
    offset = (0.1, -0.05, 0.3)
    assert at_base(at_center(motion, offset), offset) == pytest.approx(motion, abs=1e-15)


def test_arrays_give_the_bits_of_floats():
    motions = np.array(MOTIONS).T
    offset = (0.1, -0.05, 0.3)
    for function in (
        lambda *motion: wheel_speeds(*motion, REACH),
        lambda *motion: wheels_motion((*motion, motion[0]), REACH),
        lambda *motion: at_center(motion, offset),
        lambda *motion: at_base(motion, offset),
    ):
        together = np.array(function(*motions))
        for index, motion in enumerate(MOTIONS):
            assert together[:, index].tobytes() == np.array(function(*motion)).tobytes()


@pytest.mark.parametrize("subtracts", ["rotations", "distances"])
@pytest.mark.parametrize("offset", [None, (0.1, -0.05, 0.3)])
def test_wheels_estimate_the_motion_that_they_command(subtracts, offset):
    none = Limits()
    config = MecanumWheelsConfig(
        radius=0.1, reach=REACH, limits=(none, none, none), offset=offset, subtracts=subtracts
    )
    joints = [Joint(position=index) for index in range(4)]
    reckoning = DeadReckoning()
    wheels = MecanumWheels(config, [(joint,) for joint in joints], None, reckoning)
    wheels.measure(0.0)
    assert wheels.command((0.2, -0.1, 0.4), 0.1) == (0.2, -0.1, 0.4)
    for joint in joints:
        joint.position += 0.1 * joint.command
    wheels.measure(0.1)
    _, _, linear, angular = reckoning.motion()
    assert (*linear[:2], angular[2]) == pytest.approx((0.2, -0.1, 0.4))
    wheels.stop()
    assert [joint.command for joint in joints] == [0.0] * 4
