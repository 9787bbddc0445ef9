"""The base class of drives that follow Twist commands and publish odometry."""

from __future__ import annotations

from typing import Any

from cartwheel.devices.drives.odometry import Odometry, planar_motion
from cartwheel.devices.joints.states import JointStates
from cartwheel.dialects.plugin import Plugin
from cartwheel.geometry import Quat, Vec3


class Drive(Plugin[Any]):
    """Base class of wheeled drives.

    A subclass's `configure` acquires joints, creates the publishers and calls `_run`. Its `_aim`
    stores a command, `_turn_wheels` executes it, and `_motion` returns the pose and velocity.
    """

    odometry: Odometry | None = None
    joint_states: JointStates | None = None

    def _run(self, *, command_topic: str, base: str, control_rate: float, rate: float) -> None:
        """Subscribes to commands and schedules the control loop.

        Args:
            command_topic: Topic of the Twist commands.
            base: Link whose ground-truth pose is published; the root link if no link has this name.
            control_rate: Rate of the control loop, Hz.
            rate: Publish rate, Hz.
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
        """Stores a command: m/s, and ``angular.z`` as the drive interprets it."""
        raise NotImplementedError

    def _control(self) -> None:
        now = self.part.time_ns
        seconds = 0.0 if self._updated_ns is None else (now - self._updated_ns) * 1e-9
        self._updated_ns = now
        self._turn_wheels(seconds)

    def _turn_wheels(self, seconds: float) -> None:
        """Commands the joints, `seconds` after the previous call."""
        raise NotImplementedError

    def _motion(self) -> tuple[Vec3, Quat, Vec3, Vec3]:
        """Returns the ground-truth motion in the form of `planar_motion`."""
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
