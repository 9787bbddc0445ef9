"""Driven and steered wheels: what they command and what motion they estimate."""

import math

import pytest
from tests.devices.drives.joints import Joint

from cartwheel.devices.drives import steering
from cartwheel.devices.drives.limiter import Limits
from cartwheel.devices.drives.reckoning import DeadReckoning
from cartwheel.devices.drives.steered_wheels import (
    SteeredAxle,
    SteeredAxleConfig,
    SteeredByAngle,
    SteeredByAngleConfig,
    SteeredWheel,
    SteeredWheelConfig,
)

BASE, TRACK, RADIUS = 0.5, 0.4, 0.1


def velocity(reckoning):
    """Forward velocity and yaw rate of the last motion."""
    _, _, linear, angular = reckoning.motion()
    return linear[0], angular[2]


def axle(driven=1, steered=1, measures="positions"):
    config = SteeredAxleConfig(
        wheel_base=BASE, driven_track=TRACK, steered_track=TRACK, radius=RADIUS, measures=measures
    )
    wheels, forks = [Joint() for _ in range(driven)], [Joint() for _ in range(steered)]
    reckoning = DeadReckoning()
    drive = SteeredAxle(config, wheels, forks, reckoning)
    drive.restart()
    return drive, wheels, forks, reckoning


@pytest.mark.parametrize(("driven", "steered"), [(1, 1), (2, 1), (2, 2)])
@pytest.mark.parametrize("measures", ["positions", "velocities", "nothing"])
def test_an_axle_estimates_the_motion_that_it_commands(driven, steered, measures):
    drive, wheels, forks, reckoning = axle(driven, steered, measures)
    drive.command(0.4, -0.3)
    for joint in wheels:
        joint.velocity = joint.command
        joint.position += 0.1 * joint.command
    for joint in forks:
        joint.position = joint.command
    drive.measure(0.1)
    assert velocity(reckoning) == pytest.approx((0.4, -0.3))


def test_two_wheels_share_the_speed_and_the_angle_of_the_middle():
    drive, wheels, forks, _ = axle(2, 2)
    drive.command(0.4, 0.3)
    middle = math.atan(0.3 * BASE / 0.4)
    assert [fork.command for fork in forks] == pytest.approx(
        steering.wheel_angles(middle, BASE, TRACK)
    )
    factors = steering.rim_factors(middle, BASE, TRACK)
    assert [wheel.command for wheel in wheels] == pytest.approx(
        [0.4 / RADIUS * factor for factor in factors]
    )
    drive.stop()
    assert [wheel.command for wheel in wheels] == [0.0, 0.0]
    assert forks[0].command > forks[1].command > 0


def test_at_standstill_an_axle_turns_in_place():
    drive, (wheel,), (fork,), _ = axle()
    drive.command(0.0, -0.6)
    assert fork.command == -math.pi / 2
    assert wheel.command == pytest.approx(0.6 * BASE / RADIUS)


def by_angle(**more):
    limits = {"speed_limits": Limits(), "angle_limits": Limits(), **more}
    config = SteeredByAngleConfig(wheel_base=BASE, radius=RADIUS, **limits)
    wheel, fork, reckoning = Joint(position=3.0), Joint(), DeadReckoning()
    drive = SteeredByAngle(config, wheel, fork, reckoning)
    drive.restart()
    return drive, wheel, fork, reckoning


@pytest.mark.parametrize("open_loop", [False, True])
def test_a_steered_angle_gives_the_curve_of_its_tangent(open_loop):
    drive, wheel, fork, reckoning = by_angle(open_loop=open_loop)
    drive.command(0.4, 0.5, 0.1)
    assert (wheel.command, fork.command) == (pytest.approx(0.4 / RADIUS), 0.5)
    wheel.position += 0.1 * wheel.command
    fork.position = fork.command
    drive.measure(0.1)
    assert velocity(reckoning) == pytest.approx((0.4, 0.4 * math.tan(0.5) / BASE))


def test_a_factor_corrects_the_measured_angle_alone():
    drive, wheel, fork, reckoning = by_angle(angle_factor=0.5)
    drive.command(0.4, 0.5, 0.1)
    assert fork.command == 0.5
    wheel.position += 0.1 * wheel.command
    fork.position = 0.5
    drive.measure(0.1)
    assert velocity(reckoning) == pytest.approx((0.4, 0.4 * math.tan(0.25) / BASE))


def test_limits_begin_anew_after_a_restart():
    drive, wheel, _, _ = by_angle(speed_limits=Limits(acceleration=(-1.0, 1.0)))
    drive.command(0.4, 0.0, 0.1)
    drive.command(0.4, 0.0, 0.1)
    assert wheel.command == pytest.approx(0.2 / RADIUS)
    drive.restart()
    drive.command(0.4, 0.0, 0.1)
    assert wheel.command == pytest.approx(0.1 / RADIUS)


def wheel_drive(**more):
    config = SteeredWheelConfig(
        wheel_base=BASE, radius=RADIUS, **{"speed_limits": Limits(), **more}
    )
    wheel, fork, reckoning = Joint(), Joint(), DeadReckoning()
    drive = SteeredWheel(config, wheel, fork, reckoning)
    drive.restart()
    return drive, wheel, fork, reckoning


@pytest.mark.parametrize("open_loop", [False, True])
@pytest.mark.parametrize("motion", [(0.4, 0.3), (-0.4, 0.3), (0.0, -0.6)])
def test_a_driven_and_steered_wheel_estimates_the_motion_that_it_commands(motion, open_loop):
    drive, wheel, fork, reckoning = wheel_drive(open_loop=open_loop)
    drive.command(*motion, 0.1)
    fork.position = fork.command
    # The wheel now has the angle, so it gets its full speed.
    drive.command(*motion, 0.1)
    wheel.position += 0.1 * wheel.command
    drive.measure(0.1)
    assert velocity(reckoning) == pytest.approx(motion, abs=1e-12)


def test_a_wheel_waits_for_its_angle_within_its_range_and_rate():
    drive, wheel, fork, _ = wheel_drive(steering_rate=0.5, steering_range=(-0.2, 1.5))
    drive.command(0.1, 0.6, 0.1)
    wanted = math.atan(0.6 * BASE / 0.1)
    assert fork.command == pytest.approx(0.05)
    full = 0.1 / (RADIUS * math.cos(wanted))
    assert wheel.command == pytest.approx(full * math.cos(wanted))
    drive.command(0.1, -0.6, 0.1)
    assert fork.command == pytest.approx(0.0)
    drive.restart()
    for _ in range(10):
        drive.command(0.1, -0.6, 0.1)
    assert fork.command == pytest.approx(-0.2)
