"""The differential drive on wheels that need no simulation."""

from dataclasses import dataclass, replace

import pytest

from cartwheel.component import Scope
from cartwheel.devices.drives.differential import (
    DifferentialDrive,
    DifferentialDriveConfig,
    WheelPair,
)
from cartwheel.devices.drives.limiter import Limiter, Limits

RADIUS, TRACK = 0.1, 0.4
FRONT = WheelPair(
    left="fl", right="fr", separation=TRACK, left_radius=RADIUS, right_radius=2 * RADIUS
)
REAR = WheelPair(
    left="rl", right="rr", separation=2 * TRACK, left_radius=RADIUS, right_radius=RADIUS
)
CONFIG = DifferentialDriveConfig(pairs=(FRONT,), odometry="positions", drive=None)


@dataclass
class Wheel:
    position: float = 0.0
    velocity: float = 0.0
    command: float = 0.0
    qposadr: int = 0

    @property
    def state(self):
        return self

    @property
    def qpos(self):
        return [self.position]


@pytest.fixture
def wheels():
    return {name: Wheel() for name in ("fl", "fr", "rl", "rr")}


@pytest.fixture
def drive(wheels):
    def create(config=CONFIG, **more):
        scope = Scope(part=None, shared=None, node="n", title="t", origin=None)
        return DifferentialDrive(scope, config, wheel_of=wheels.__getitem__, **more)

    return create


def test_each_wheel_turns_by_its_own_radius_and_separation(drive, wheels):
    device = drive(replace(CONFIG, pairs=(FRONT, REAR)))
    device.command(0.6, 0.0, 1.0)
    device.actuate(0.1)
    assert [wheel.command for wheel in wheels.values()] == pytest.approx(
        [(0.6 - 0.2) / 0.1, (0.6 + 0.2) / 0.2, (0.6 - 0.4) / 0.1, (0.6 + 0.4) / 0.1]
    )


def test_rims_gain_speed_along_a_ramp(drive, wheels):
    device = drive(replace(CONFIG, acceleration=1.0))
    device.command(0.25, 0.0, 0.0)
    speeds = []
    for _ in range(4):
        device.actuate(0.1)
        speeds.append(wheels["fl"].command * RADIUS)
    assert speeds == pytest.approx([0.1, 0.2, 0.25, 0.25])


def test_a_command_continues_the_ramp_on_which_another_one_was(drive, wheels):
    """Although the first command had reached its speed before."""
    limits = Limits(acceleration=(-1.0, 1.0))
    device = drive(replace(CONFIG, linear=limits, angular=limits))
    limiter = Limiter(limits)
    for wanted in (0.2,) * 5 + (0.9,) * 3 + (0.2,) * 9 + (0.0, 0.2) * 2:
        device.command(wanted, 0.0, 0.0)
        device.actuate(0.1)
        assert wheels["fl"].command == limiter.step(wanted, 0.1) / RADIUS
    assert device.linear.value == limiter.value


@pytest.mark.parametrize(("period", "speed"), [(None, 0.2), (0.05, 0.1)])
def test_limits_count_the_measured_time_or_a_fixed_one(drive, wheels, period, speed):
    limits = Limits(acceleration=(-2.0, 2.0))
    device = drive(replace(CONFIG, linear=limits, limit_period=period))
    device.command(1.0, 0.0, 0.0)
    device.actuate(0.1)
    assert wheels["fl"].command * RADIUS == pytest.approx(speed)


def roll(wheels, **ways):
    for name, way in ways.items():
        wheels[name].position += way
        wheels[name].velocity = way / 0.1


def test_odometry_measures_the_first_pair_or_the_mean_of_all(drive, wheels):
    pairs = (replace(FRONT, right_radius=RADIUS), REAR)
    first = drive(replace(CONFIG, pairs=pairs))
    both = drive(replace(CONFIG, pairs=pairs, measured_pairs=None))
    for device in (first, both):
        device.start()
    roll(wheels, fl=1.0, fr=1.0, rl=3.0, rr=3.0)
    for device in (first, both):
        device.measure(0.1)
    assert first.reckoning.pose == pytest.approx((0.1, 0.0, 0.0))
    assert both.reckoning.pose == pytest.approx((0.2, 0.0, 0.0))


@pytest.mark.parametrize("source", ["positions", "velocities"])
def test_positions_and_velocities_give_the_same_path(drive, wheels, source):
    device = drive(replace(CONFIG, odometry=source))
    device.start()
    roll(wheels, fl=1.0, fr=1.5)
    device.measure(0.1)
    *_, heading = device.reckoning.pose
    assert heading == pytest.approx((1.5 * 2 * RADIUS - 1.0 * RADIUS) / TRACK)


def test_without_feedback_the_odometry_follows_the_limited_commands(drive):
    device = drive(replace(CONFIG, odometry="commands", linear=Limits(velocity=(-0.5, 0.5))))
    device.command(2.0, 0.0, 0.0)
    device.actuate(0.1)
    device.measure(0.1)
    assert device.reckoning.pose == pytest.approx((0.05, 0.0, 0.0))


def test_a_gyroscope_replaces_the_rotation_that_the_wheels_measure(drive, wheels):
    device = drive(yaw_rate=lambda: 3.0)
    device.start()
    roll(wheels, fl=1.0, fr=0.5)
    device.measure(0.1)
    *_, heading = device.reckoning.pose
    assert heading == pytest.approx(0.3)


def test_a_drive_commands_no_wheel_before_it_runs(drive, wheels):
    wheels["fl"].command = 7.0
    device = drive()
    device.start()
    assert wheels["fl"].command == 7.0
    device.reset()
    assert wheels["fl"].command == 0.0
