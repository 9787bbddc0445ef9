"""The base class of controllers that drive wheels from Twist commands and publish odometry."""

from __future__ import annotations

from abc import abstractmethod
from typing import ClassVar, Protocol

from cartwheel.devices.drives.wheel_odometry import WheelOdometry
from cartwheel.dialects.ros_control.controller import Controller
from cartwheel.dialects.ros_control.controllers.twist_command import TwistCommand
from cartwheel.geometry import Vec3


class Wheels(Protocol):
    """The wheels of a drive, which estimate the robot's motion."""

    def restart(self) -> None:
        """Restarts the estimate."""

    def measure(self, seconds: float) -> None:
        """Updates the estimate by the motion in the last `seconds`."""

    def stop(self) -> None:
        """Stops the wheels."""


class WheelController(Controller):
    """Measures wheels, publishes their odometry, and then commands them.

    `configure` sets the command, the odometry and the wheels.
    """

    sideways: ClassVar[bool] = False
    """Whether ``linear.y`` of the commands is followed."""
    _command: TwistCommand
    _odometry: WheelOdometry
    _wheels: Wheels

    def start(self, time_ns: int) -> None:
        self._command.stop()
        self._odometry.start(time_ns)
        self._wheels.restart()

    def update(self, time_ns: int, seconds: float) -> None:
        self._wheels.measure(seconds)
        self._odometry.publish(time_ns)
        self._drive(self._command.at(time_ns), time_ns, seconds)

    def stop(self, time_ns: int) -> None:  # noqa: ARG002
        self._wheels.stop()

    def commanded(self, forward: float, turn: float) -> tuple[float, float]:
        """The velocity that a command without a sideways part asks for: m/s in x and rad/s.

        Args:
            forward: ``linear.x``, m/s.
            turn: ``angular.z``, rad/s or rad.
        """
        return forward, turn

    @abstractmethod
    def _drive(self, command: Vec3, time_ns: int, seconds: float) -> None:
        """Commands the wheels to follow x and y velocities in m/s and a yaw rate in rad/s."""
