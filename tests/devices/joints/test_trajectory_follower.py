"""Joints that follow trajectories, without a simulation."""

import math

import pytest

from cartwheel.devices.joints.pid import PidGains
from cartwheel.devices.joints.trajectory import Trajectory, Waypoint
from cartwheel.devices.joints.trajectory_follower import FollowerConfig, TrajectoryFollower
from cartwheel.devices.joints.trajectory_tolerances import Tolerance

SECOND = 1_000_000_000


class Joint:
    """A joint that records its command."""

    def __init__(self, position=0.0, velocity=0.0):
        self.position, self.velocity, self.lightness = position, velocity, 0.0
        self.command = self.rate = 0.0

    def error(self, target):
        return target - self.position

    def set_effort(self, command):
        self.applied = command

    def tune(self, pid):
        self.tuned = pid


def line(start_ns, *, end=2.0, seconds=2.0):
    """A trajectory from 0 to `end`."""
    points = [Waypoint(time=0, position=(0.0,)), Waypoint(time=seconds, position=(end,))]
    return Trajectory(start_ns, points)


def test_positions_are_commanded_with_their_rate():
    joint = Joint(position=0.4)
    follower = TrajectoryFollower([joint], FollowerConfig(interface="position"))
    follower.follow(line(0), 0)
    tracking = follower.update(SECOND // 2, 0.01)
    assert (joint.command, joint.rate) == (0.5, 1.0)
    assert tracking.errors == [(pytest.approx(0.1), 1.0)]


def test_a_trajectory_that_starts_later_replaces_the_current_one_then():
    joint = Joint(position=0.7)
    follower = TrajectoryFollower([joint], FollowerConfig(interface="position"))
    follower.start(0)
    follower.follow(line(SECOND), 0)
    assert follower.waits
    assert follower.end_ns == 3 * SECOND
    follower.update(SECOND - 1, 0.01)
    assert (joint.command, joint.rate) == (0.7, 0.0)
    assert follower.at(2 * SECOND).position == (1.0,)
    follower.update(2 * SECOND, 0.01)
    assert joint.command == 1.0
    assert not follower.waits


def test_holding_forgets_both_trajectories():
    joint = Joint(position=0.3)
    follower = TrajectoryFollower([joint], FollowerConfig(interface="position"))
    follower.follow(line(0), 0)
    follower.follow(line(SECOND), 0)
    follower.hold(SECOND // 2)
    follower.update(2 * SECOND, 0.01)
    assert joint.command == 0.3


def test_efforts_and_velocities_are_the_outputs_of_pid_controllers_plus_feedforward():
    gains = PidGains(p=10.0, d=2.0)
    for interface in ("effort", "velocity"):
        joint = Joint(position=0.4, velocity=0.9)
        config = FollowerConfig(interface=interface, gains=(gains,), feedforward=(3.0,))
        follower = TrajectoryFollower([joint], config)
        follower.follow(line(0), 0)
        follower.update(SECOND // 2, 0.01)
        output = joint.applied.at(0.9) if interface == "effort" else joint.command
        assert output == pytest.approx(10.0 * 0.1 + 2.0 * (1.0 - 0.9) + 3.0 * 1.0)


def test_a_tolerance_of_zero_is_not_checked():
    assert not Tolerance().violated(math.inf, math.inf)
    assert Tolerance(position=0.1).violated(-0.2, 0.0)
    assert not Tolerance(position=0.1).violated(0.1, 5.0)
    assert Tolerance(velocity=0.1).violated(0.0, 0.2)
