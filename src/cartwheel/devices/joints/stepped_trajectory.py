"""Joints whose target is one point of a trajectory after the other, without interpolation."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from cartwheel.codes import running
from cartwheel.component import Component, Scope
from cartwheel.devices.joints.pid import Pid, PidGains
from cartwheel.devices.joints.trajectory import next_point
from cartwheel.devices.periodic import Elapsed
from cartwheel.messages import header, message_class, nanoseconds, zero
from cartwheel.simulation.dynamics.joint_servo import ServoHandle
from cartwheel.simulation.handles import JointHandle

_TRAJECTORY = "trajectory_msgs/msg/JointTrajectory"


@dataclass(frozen=True, kw_only=True, slots=True)
class SteppedJointConfig:
    name: str
    """Name of the joint."""
    initial: float = 0.0
    """Target position before the first trajectory, rad or m."""
    position: PidGains
    """Gains of the position controller. The derivative gain damps the joint."""
    velocity: PidGains
    """Gains of the velocity controller. The derivative gain has no effect."""


@dataclass(frozen=True, kw_only=True, slots=True)
class SteppedTrajectoryConfig:
    joints: tuple[SteppedJointConfig, ...]
    """The controlled joints."""
    topic: str
    """Topic of the trajectories (JointTrajectory)."""
    header_start: bool = False
    """Start trajectories at their header stamp instead of on arrival."""


class SteppedTrajectory(Component):
    """Drives joints to the points of a trajectory, one after the other.

    Each point is the target until its ``time_from_start`` has passed. The effort is the sum of the
    position controller's output, the velocity controller's output and the point's effort.
    ``<topic>_progress`` (Float32) is the number of the current point divided by the total number.

    Raises:
        UnknownNameError: A joint does not exist.
    """

    def __init__(self, scope: Scope, config: SteppedTrajectoryConfig) -> None:
        super().__init__(scope)
        part, origin = self.part, self.origin
        self._config = config
        names = [joint.name for joint in config.joints]
        joints = [part.joint(name, origin=origin) for name in names]
        servos = [part.servo(name, max_effort=None, origin=origin) for name in names]
        self._handles = list(zip(config.joints, joints, servos, strict=True))
        self.subscribe(config.topic, _TRAJECTORY, self._on_trajectory)
        self.take_positions(names, self._publish_target)
        self._Float = message_class("std_msgs/msg/Float32")
        self._progress = self.advertise(f"{config.topic}_progress", "std_msgs/msg/Float32")
        self.reset()
        part.schedule(0, before=self._follow).reads_state = True

    def reset(self) -> None:
        self._controllers = {
            joint.name: _Controller(joint, handle, servo) for joint, handle, servo in self._handles
        }
        self._names: list[str] = []
        self._points: list[Any] = []
        self._ends: list[int] = []
        """Times since the start until which the points are targets, ns; the last has no end."""
        self._index = 0
        self._start_ns = 0
        self._elapsed = Elapsed()

    def _on_trajectory(self, message: Any) -> None:
        names = list(message.joint_names)
        if not any(name in self._controllers for name in names):
            self.warn(
                running.TRAJECTORY_INVALID,
                "a trajectory is ignored: it contains no joint of the model",
                hint=f"Valid names: {', '.join(self._controllers)}.",
                values={"fault": "joints"},
            )
            return
        for point in message.points:
            for what in ("positions", "velocities", "effort"):
                values = getattr(point, what)
                if len(values) not in (0, len(names)):
                    self.warn(
                        running.TRAJECTORY_INVALID,
                        f"a trajectory is ignored because a point has {len(values)} {what} for "
                        f"{len(names)} joints",
                        values={"fault": what},
                    )
                    return
        self._names, self._points, self._index = names, list(message.points), 0
        self._ends = [nanoseconds(point.time_from_start) for point in self._points[:-1]]
        self._start_ns = self.part.time_ns
        if self._config.header_start:
            self._start_ns = nanoseconds(message.header.stamp)
        if self._points:
            self._set_targets()

    def _publish_target(self, wanted: Mapping[str, float], seconds: float) -> None:  # noqa: ARG002
        point = zero("trajectory_msgs/msg/JointTrajectoryPoint")
        point.positions = np.array(list(wanted.values()))
        message = message_class(_TRAJECTORY)(
            header=header(0, ""), joint_names=list(wanted), points=[point]
        )
        self.graph.publish(self.resolve(self._config.topic), _TRAJECTORY, message)

    def _set_targets(self) -> None:
        """Sets the targets from the current point."""
        point = self._points[self._index]
        for number, name in enumerate(self._names):
            controller = self._controllers.get(name)
            if controller is None:
                continue
            if len(point.positions):
                controller.position = float(point.positions[number])
            if len(point.velocities):
                controller.velocity = float(point.velocities[number])
            if len(point.effort):
                controller.effort = float(point.effort[number])
        if self._progress.wanted:
            self._progress.publish(self._Float((self._index + 1) / len(self._points)))

    def _follow(self) -> None:
        now = self.part.time_ns
        index = next_point(self._ends, self._index, now - self._start_ns)
        if index != self._index:
            self._index = index
            self._set_targets()
        seconds = self._elapsed.seconds(now)
        for controller in self._controllers.values():
            controller.update(seconds)


class _Controller:
    """A joint with its target and its two PID controllers."""

    def __init__(self, config: SteppedJointConfig, joint: JointHandle, servo: ServoHandle) -> None:
        self._joint, self._servo = joint, servo
        self._position, self._velocity = Pid(config.position), Pid(config.velocity)
        self._damping, self._speed_damping = config.position.d, 0.0
        if math.isinf(config.velocity.u_max):
            # A velocity gain acts as damping, which the servo applies without delay.
            self._speed_damping = config.velocity.p
        self.position = config.initial
        """Target position, rad or m."""
        self.velocity = 0.0
        """Target velocity, rad/s or m/s."""
        self.effort = 0.0
        """Effort of the trajectory's point, N m or N."""

    def update(self, seconds: float) -> None:
        """Applies the effort for the target; `seconds` is the time since the last call."""
        velocity = self._joint.velocity
        position_effort = self._position.effort(self.position - self._joint.position, seconds)
        velocity_effort = self._velocity.effort(self.velocity - velocity, seconds)
        self._servo.command_effort(
            self.effort + position_effort + (velocity_effort + self._speed_damping * velocity),
            damping=self._damping + self._speed_damping,
        )
