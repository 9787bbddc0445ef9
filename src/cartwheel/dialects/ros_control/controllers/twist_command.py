"""The Twist commands of a controller, which expire."""

from __future__ import annotations

import math
from typing import Any

from cartwheel.devices.drives.timeouts import CommandTimeouts
from cartwheel.dialects.ros_control.controller import Controller

_NEVER = -(1 << 62)
_NONE = (0.0, 0.0, 0.0)


class TwistCommand:
    """The last Twist command, which expires.

    Args:
        controller: The controller that subscribes to the topic.
        topic: Name of the topic.
        timeout: Time after which a command expires, s; 0: never.
        stamped: Whether the type is TwistStamped.
    """

    def __init__(
        self, controller: Controller, topic: str, *, timeout: float, stamped: bool = False
    ) -> None:
        self._part = controller.part
        self._timeout_ns = round(timeout * 1e9)
        if self._timeout_ns > 0:
            controller.shared.get(CommandTimeouts).set(controller.node, timeout)
        self._stamped = stamped
        self.stop()
        controller.subscribe(
            topic, f"geometry_msgs/msg/Twist{'Stamped' if stamped else ''}", self._on_command
        )

    def stop(self) -> None:
        """Clears the command."""
        self._values = _NONE
        self.time_ns = _NEVER
        """Time of the last command; before all times if there is none."""

    def at(self, time_ns: int) -> tuple[float, float, float]:
        """Returns x and y velocities in m/s and the yaw rate in rad/s; 0 after the timeout.

        The tuple is the same one until the command changes.
        """
        if self._timeout_ns > 0 and time_ns - self.time_ns > self._timeout_ns:
            return _NONE
        return self._values

    def _on_command(self, message: Any) -> None:
        twist = message.twist if self._stamped else message
        values = (float(twist.linear.x), float(twist.linear.y), float(twist.angular.z))
        if all(math.isfinite(value) for value in values):
            self._values = values
            self.time_ns = self._part.time_ns
