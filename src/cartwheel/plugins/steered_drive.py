"""What drives with steered wheels share: joints, what is told, and the ramp of an angle."""

from __future__ import annotations

import math
from typing import Any

from cartwheel.plugins.base import Plugin
from cartwheel.plugins.odometry import DeadReckoning, Odometry, planar_motion
from cartwheel.plugins.wheel_states import JointStates


def toward(value: float, target: float, most: float) -> float:
    """A value moved towards a target by at most `most`."""
    return value + min(max(target - value, -most), most)


class SteeredDrive(Plugin[Any]):
    """Takes Twists; a subclass steers in `_steer` and says where it is in `_motion`."""

    odometry: Odometry | None = None
    joint_states: JointStates | None = None

    def _run(self, *, command_topic: str, base: str, control_rate: float, rate: float) -> None:
        """Subscribes and schedules; rates in Hz."""
        description = self.part.description
        known = description.link(base) is not None
        self._base = self.part.link(base if known else description.canonical_link)
        self._reckoning = DeadReckoning()
        self.subscribe(command_topic, "geometry_msgs/msg/Twist", self._on_command)
        self.part.schedule(control_rate, before=self._control)
        self.part.schedule(rate, after=self._publish, active=self._wanted)
        self.reset()

    def reset(self) -> None:
        self._forward = self._turn = 0.0
        """The command: m/s, and rad or rad/s as the drive takes it."""
        self._updated_ns: int | None = None
        self._reckoning.restart()

    def close(self) -> None:
        if self.odometry is not None:
            self.odometry.close()
        super().close()

    def _on_command(self, message: Any) -> None:
        forward, turn = float(message.linear.x), float(message.angular.z)
        if not (math.isfinite(forward) and math.isfinite(turn)):
            self.warn("a command that is not finite was ignored")
            return
        self._forward, self._turn = forward, turn

    def _control(self) -> None:
        now = self.part.time_ns
        seconds = 0.0 if self._updated_ns is None else (now - self._updated_ns) * 1e-9
        self._updated_ns = now
        self._steer(seconds)

    def _steer(self, seconds: float) -> None:
        """Commands the joints, `seconds` after the last time."""
        raise NotImplementedError

    def _motion(self) -> Any:
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
