"""Joints that follow a trajectory, and hold a position otherwise."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from cartwheel.devices.joints.actuator import JointActuator
from cartwheel.devices.joints.pid import DampedEffort, Pid, PidGains
from cartwheel.devices.joints.trajectory import State, Trajectory


@dataclass(frozen=True, kw_only=True, slots=True)
class FollowerConfig:
    interface: Literal["position", "velocity", "effort"]
    """Command of the joints."""
    gains: tuple[PidGains, ...] = ()
    """Gains of each joint's PID controller, which computes velocities or efforts; empty for
    positions."""
    feedforward: tuple[float, ...] = ()
    """Output per desired velocity that is added to the PID controller's, for each joint."""


@dataclass(frozen=True, slots=True)
class Tracking:
    """The desired state at one time, and the errors of the joints."""

    desired: State
    errors: list[tuple[float, float]]
    """Desired minus actual position in rad or m and velocity in rad/s or m/s, for each joint."""


class TrajectoryFollower:
    """Commands joints so that they follow a trajectory.

    Args:
        joints: The joints, in the order of the trajectories.
        config: Commands and gains.
    """

    def __init__(self, joints: Sequence[JointActuator], config: FollowerConfig) -> None:
        self._joints = list(joints)
        self._config = config
        self._pids = [Pid(gains) for gains in config.gains]
        for joint, pid in zip(self._joints, self._pids, strict=False):
            joint.tune(pid)
        self.current = Trajectory.hold(0, [0.0] * len(self._joints))
        """The trajectory that the joints follow now."""
        self._next: Trajectory | None = None

    def start(self, time_ns: int) -> None:
        """Holds the current position and resets the PID controllers."""
        self.hold(time_ns)
        for pid in self._pids:
            pid.reset()

    def hold(self, time_ns: int) -> None:
        """Holds the current position."""
        self._next = None
        self.current = Trajectory.hold(time_ns, [joint.position for joint in self._joints])

    def follow(self, trajectory: Trajectory, time_ns: int) -> None:
        """Follows a trajectory from its start on; until then, the current one continues."""
        if trajectory.start_ns > time_ns:
            self._next = trajectory
        else:
            self.current, self._next = trajectory, None

    @property
    def waits(self) -> bool:
        """Whether a trajectory will start later."""
        return self._next is not None

    @property
    def end_ns(self) -> int:
        """Simulation time of the last point of the latest trajectory."""
        return (self._next or self.current).end_ns

    def at(self, time_ns: int) -> State:
        """Returns the desired state at a simulation time."""
        if self._next is not None and time_ns >= self._next.start_ns:
            return self._next.at(time_ns)
        return self.current.at(time_ns)

    def update(self, time_ns: int, seconds: float) -> Tracking:
        """Commands the joints.

        Args:
            time_ns: Simulation time.
            seconds: Time since the last call, s.
        """
        if self._next is not None and time_ns >= self._next.start_ns:
            self.current, self._next = self._next, None
        desired = self.current.at(time_ns)
        errors = []
        by_position, control = self._config.interface == "position", self._control
        for index, joint in enumerate(self._joints):
            position, rate = desired.position[index], desired.velocity[index]
            error, velocity = joint.error(position), joint.velocity
            errors.append((error, rate - velocity))
            if by_position:
                joint.command, joint.rate = position, rate
            else:
                control(index, desired, error, velocity, seconds)
        return Tracking(desired, errors)

    def _control(
        self, index: int, desired: State, error: float, velocity: float, seconds: float
    ) -> None:
        """Commands a joint by its PID controller.

        Args:
            index: Index of the joint.
            desired: Desired state of all joints.
            error: Position error, rad or m.
            velocity: Velocity of the joint, rad/s or m/s.
            seconds: Time since the last call, s.
        """
        target, rate = desired.position[index], desired.velocity[index]
        joint, pid = self._joints[index], self._pids[index]
        by_effort = self._config.interface == "effort"
        lightness = joint.lightness if by_effort else 0.0
        command = pid.position(error, seconds, target=target, rate=rate, lightness=lightness)
        command = pid.limited(command, velocity)
        forward = self._config.feedforward[index] * rate
        if not by_effort:
            joint.command = command.at(velocity) + forward
        elif forward:
            joint.set_effort(DampedEffort(command.effort + forward, command.damping))
        else:
            joint.set_effort(command)
