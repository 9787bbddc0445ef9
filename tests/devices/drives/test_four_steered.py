"""Four steered wheels: what each does for a motion, and the motion that they measure."""

import math

import pytest
from tests.devices.drives.joints import Joint

from cartwheel.devices.drives.four_steered import (
    Axles,
    FourSteeredConfig,
    FourSteeredWheels,
    axles_of_angles,
    axles_of_turn,
    motion_of_axles,
)
from cartwheel.devices.drives.limiter import NO_LIMITS, Limits
from cartwheel.devices.drives.reckoning import DeadReckoning

BASE, TRACK, RADIUS = 0.6, 0.4, 0.1


def config(offset=0.0, **more):
    given = {"speed_limits": NO_LIMITS, "turn_limits": NO_LIMITS, "window": 10, **more}
    return FourSteeredConfig(wheel_base=BASE, track=TRACK, offset=offset, radius=RADIUS, **given)


@pytest.mark.parametrize("forward", [0.5, -0.5])
@pytest.mark.parametrize("turn", [0.0, 0.4, -0.4])
def test_each_wheel_rolls_along_the_velocity_of_its_place(forward, turn):
    """A rigid body that turns about a point: no wheel slips, neither ahead nor sideways."""
    axles = axles_of_turn(config(), forward, turn)
    places = {"front": BASE / 2, "rear": -BASE / 2}
    for name, x in places.items():
        speeds, angles = getattr(axles, f"{name}_speeds"), getattr(axles, f"{name}_angles")
        for speed, angle, y in zip(speeds, angles, (TRACK / 2, -TRACK / 2), strict=True):
            rolled = speed * RADIUS
            assert rolled * math.cos(angle) == pytest.approx(forward - turn * y)
            assert rolled * math.sin(angle) == pytest.approx(turn * x, abs=1e-15)


def test_a_wheel_beside_its_steering_axis_rolls_further():
    plain, beside = axles_of_turn(config(), 0.5, 0.4), axles_of_turn(config(0.05), 0.5, 0.4)
    left, right = (
        (after - before) * RADIUS
        for before, after in zip(plain.front_speeds, beside.front_speeds, strict=True)
    )
    assert (left, right) == pytest.approx((-0.4 * 0.05, 0.4 * 0.05))
    assert beside.front_angles == plain.front_angles


def test_it_does_not_turn_in_place():
    assert axles_of_turn(config(), 0.0, 1.0) == ((0.0, 0.0), (0.0, 0.0), (0.0, 0.0), (-0.0, -0.0))


def test_equal_angles_move_it_sideways():
    axles = axles_of_angles(config(), 0.5, 0.3, 0.3)
    assert (*axles.front_angles, *axles.rear_angles) == pytest.approx((0.3,) * 4)
    assert (*axles.front_speeds, *axles.rear_speeds) == pytest.approx((0.5 / RADIUS,) * 4)
    motion = motion_of_axles(config(), axles)
    assert motion == pytest.approx((0.5 * math.cos(0.3), 0.5 * math.sin(0.3), 0.0, 0.3, 0.3))


@pytest.mark.parametrize("offset", [0.0, 0.05])
@pytest.mark.parametrize("turn", [0.0, 0.4, -0.3])
def test_the_wheels_of_a_turn_measure_that_turn(turn, offset):
    motion = motion_of_axles(config(offset), axles_of_turn(config(offset), 0.5, turn))
    assert motion.forward == pytest.approx(0.5)
    assert motion.turn == pytest.approx(turn, abs=1e-12)
    assert motion.sideways == pytest.approx(0.0, abs=1e-12)
    assert motion.front == pytest.approx(math.atan(turn * BASE / 2 / 0.5))


def test_the_angles_of_both_axles_determine_the_curve():
    """The yaw rate is the velocity times the difference of the tangents, per wheel base."""
    front, rear = 0.4, -0.1
    axles = axles_of_angles(config(), 0.5, front, rear)
    motion = motion_of_axles(config(), axles)
    assert motion.turn == pytest.approx(0.5 * (math.tan(front) - math.tan(rear)) / BASE, rel=1e-3)
    assert (motion.front, motion.rear) == pytest.approx((front, rear))


def made(**more):
    wheels, steering = [Joint() for _ in range(4)], [Joint() for _ in range(4)]
    device = FourSteeredWheels(config(**more), wheels, steering, DeadReckoning())
    device.restart()
    return device, wheels, steering


def follow(device, wheels, steering, seconds):
    for wheel in wheels:
        wheel.velocity = wheel.command
    for joint in steering:
        joint.position = joint.command
    device.measure(seconds)


def test_acceleration_and_steering_rate_are_means_of_the_last_measurements():
    """Five steps of 0.01 s with 0.2 m/s² each, and a front angle that grows by 0.5 rad/s."""
    device, wheels, steering = made(window=5)
    for step in range(1, 11):
        device.command_angles(0.5 + 0.002 * step, 0.005 * step, 0.005 * step, 0.01)
        follow(device, wheels, steering, 0.01)
    assert device.rate("acceleration") == pytest.approx(0.2, rel=1e-6)
    assert device.rate("front") == device.rate("rear") == pytest.approx(0.5, rel=1e-6)
    assert device.rate("jerk") == pytest.approx(
        # The mean acceleration falls as the first jump to 0.5 m/s leaves the mean.
        (0.2 - (0.502 / 0.01 + 4 * 0.2) / 5) / 0.05
    )
    assert device.speed == pytest.approx(0.52)


def test_limits_bind_a_turn():
    limits = {
        "speed_limits": Limits(velocity=(-0.2, 0.2)),
        "turn_limits": Limits(velocity=(-0.1, 0.1)),
    }
    device, wheels, steering = made(**limits)
    device.command(1.0, 1.0, 0.01)
    follow(device, wheels, steering, 0.01)
    assert (device.motion.forward, device.motion.turn) == pytest.approx((0.2, 0.1))
    device.stop()
    assert [each.command for each in (*wheels, *steering)] == [0.0] * 8


def test_wheels_that_stand_do_not_move_it():
    still = Axles((0.0, 0.0), (0.0, 0.0), (0.3, 0.25), (0.0, 0.0))
    assert motion_of_axles(config(), still)[:3] == (0.0, 0.0, 0.0)
