"""What takes Twists and tells where that took the robot."""

from __future__ import annotations

from typing import Any

from cartwheel.geometry import Quat, Vec3
from cartwheel.plugins.base import Plugin
from cartwheel.plugins.odometry import Odometry, planar_motion
from cartwheel.plugins.wheel_states import JointStates


class Drive(Plugin[Any]):
    """Base of the drives on wheels.

    A subclass's `configure` takes joints, makes what tells, and calls `_run`; its `_aim` takes
    a command, `_turn_wheels` obeys it, and `_motion` is where the robot is.
    """

    odometry: Odometry | None = None
    joint_states: JointStates | None = None

    def _run(self, *, command_topic: str, base: str, control_rate: float, rate: float) -> None:
        """Subscribes and schedules.

        Args:
            command_topic: Twist.
            base: Link whose true pose is told; the root where it is a frame's and no link's.
            control_rate: Hz.
            rate: Hz, of what is told.
        """
        self._base = self.link_or_root(base)
        self.subscribe(command_topic, "geometry_msgs/msg/Twist", self._on_command)
        self.part.schedule(control_rate, before=self._control)
        self.part.schedule(rate, after=self._publish, active=self._wanted)
        self.reset()

    def reset(self) -> None:
        self._updated_ns: int | None = None

    def _on_command(self, message: Any) -> None:
        self._aim(float(message.linear.x), float(message.angular.z))

    def _aim(self, forward: float, turn: float) -> None:
        """Takes a command: m/s, and what the drive takes ``angular.z`` for."""
        raise NotImplementedError

    def _control(self) -> None:
        now = self.part.time_ns
        seconds = 0.0 if self._updated_ns is None else (now - self._updated_ns) * 1e-9
        self._updated_ns = now
        self._turn_wheels(seconds)

    def _turn_wheels(self, seconds: float) -> None:
        """Commands the joints, `seconds` after the last time."""
        raise NotImplementedError

    def _motion(self) -> tuple[Vec3, Quat, Vec3, Vec3]:
        """As `planar_motion`; the true one."""
        return planar_motion(self._base)

    def _wanted(self) -> bool:
        if self.odometry is not None and self.odometry.wanted():
            return True
        return self.joint_states is not None and self.joint_states.wanted()

    def _publish(self) -> None:
        now = self.part.time_ns
        if self.joint_states is not None and self.joint_states.wanted():
            self.joint_states.publish(now)
        if self.odometry is not None and self.odometry.wanted():
            self.odometry.publish(now, *self._motion())
