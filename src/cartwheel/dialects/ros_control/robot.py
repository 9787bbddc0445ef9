"""What all controllers of a robot share: its joints, its sensors and their manager's names."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from cartwheel.description.model import Sensor
from cartwheel.devices.contact.loads import JointLoad
from cartwheel.devices.inertial.unit import InertialUnit
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.ros_control.hardware import Hardware
from cartwheel.errors import CartwheelError
from cartwheel.simulation.dynamics.external_servos import BodyDriveHandle


@dataclass(frozen=True, kw_only=True, slots=True)
class RobotSensor:
    """A sensor that broadcasters can publish."""

    name: str
    type: str
    """``imu`` or ``force_torque``."""
    sensor: Sensor
    unit: InertialUnit | JointLoad
    """Measures the sensor, for all controllers."""


class ControlledRobot:
    """The parts of a robot that its controllers share.

    Args:
        plugin: The plugin of the controller manager.
        hardware: The joints.
        namespace: Namespace of the controllers.
        ros2: Use the names and defaults of ros2_control.
        sensors: Sensors that broadcasters can publish.
        push: Servo that moves the whole robot; None if no controller needs one.
        priorities: The command interfaces. A joint with several commands follows the first one.
    """

    def __init__(
        self,
        plugin: Plugin[Any],
        hardware: Hardware,
        *,
        namespace: str,
        ros2: bool,
        sensors: Sequence[RobotSensor] = (),
        push: BodyDriveHandle | None = None,
        priorities: Sequence[str] = ("position", "velocity", "effort"),
    ) -> None:
        self.plugin = plugin
        self.hardware = hardware
        self.namespace = namespace
        self.ros2 = ros2
        self.sensors = {each.name: each for each in sensors}
        self.push = push
        self.priorities = tuple(priorities)
        """Moves a robot whose wheels cannot do so by friction: mecanum wheels without rollers."""
        self.period_ns = 0
        """Control period, ns."""
        self.remappings: dict[str, Mapping[str, str]] = {}
        """Remapped topic names, by controller."""
        self.spaces: dict[str, str] = {}
        """Namespaces of controllers in that of the robot, by controller."""
        self.take_over: Callable[[str], None] = _refuse
        """Starts a controller and stops those that command its joints; see
        `ControllerManager.take_over`."""

    def report_error(self, error: CartwheelError) -> None:
        """Reports the error of a request as a warning."""
        self.plugin.warn(
            error.code, error.message, at=error.origin, hint=error.hint or "", values=error.values
        )


def _refuse(_: str) -> None:
    """Starts no controller, because there is no manager yet."""
