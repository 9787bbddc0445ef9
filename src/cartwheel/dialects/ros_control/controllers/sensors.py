"""Sensor broadcasters: IMU and force-torque."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np

from cartwheel.codes import running
from cartwheel.devices.contact.loads import JointLoad
from cartwheel.devices.contact.wrench import WRENCH_STAMPED, wrench_stamped
from cartwheel.devices.inertial.messages import imu_message
from cartwheel.devices.inertial.unit import InertialUnit
from cartwheel.devices.periodic import Periodic
from cartwheel.dialects.ros_control.controller import Controller
from cartwheel.dialects.ros_control.robot import RobotSensor
from cartwheel.dialects.ros_control.settings import Settings
from cartwheel.errors import UnknownNameError
from cartwheel.geometry import Array
from cartwheel.graph import Publisher
from cartwheel.messages import header


class _SensorBroadcaster(Controller):
    """Base class of broadcasters, which publish the measurements of one sensor type."""

    kind: ClassVar[str]
    message: ClassVar[str]
    topic: ClassVar[str]

    def configure(self, settings: Settings) -> None:
        self._outputs: list[tuple[RobotSensor, Publisher, str]] = []
        rate = 0.0 if self.robot.ros2 else settings.number("publish_rate")
        self._periodic = Periodic(rate)
        sensors = [each for each in self.robot.sensors.values() if each.type == self.kind]
        if self.robot.ros2:
            name = settings.text("sensor_name", "")
            if not name and len(sensors) == 1:
                name = sensors[0].name
            if name not in [each.name for each in sensors]:
                raise UnknownNameError(
                    f"{self.kind} sensor",
                    name,
                    [each.name for each in sensors],
                    code=running.UNKNOWN_SENSOR,
                )
            chosen = self.robot.sensors[name]
            frame = settings.text("frame_id", chosen.sensor.link)
            self._outputs.append((chosen, self.advertise(self.topic, self.message), frame))
        else:
            if not sensors:
                raise settings.error(
                    running.UNKNOWN_SENSOR,
                    f"the robot has no {self.kind} sensor in a <gazebo> tag",
                    values={"type": self.kind},
                )
            space = f"/{self.robot.namespace.strip('/')}/"
            self._outputs = [
                (
                    each,
                    self.advertise(f"{space}{each.name}", self.message, rate=rate),
                    each.sensor.link,
                )
                for each in sensors
            ]
        self.read_settings(settings)

    def read_settings(self, settings: Settings) -> None:
        """Reads the other parameters."""

    def start(self, time_ns: int) -> None:
        self._periodic.start(time_ns)

    @property
    def senses(self) -> bool:  # type: ignore[override]
        return any(publisher.wanted for _, publisher, _ in self._outputs)

    def sense(self, time_ns: int) -> None:
        if not self._periodic.due(time_ns):
            return
        for sensed, publisher, frame in self._outputs:
            if publisher.wanted:
                publisher.publish(self.measure(sensed, header(time_ns, self.frame(frame))))

    def measure(self, sensed: RobotSensor, head: Any) -> Any:
        """Returns the message of a measurement."""
        raise NotImplementedError


class ImuBroadcaster(_SensorBroadcaster):
    """Publishes Imu messages: on ``imu`` below its name in ROS 2, on the sensor's name in ROS 1.

    Angular velocity and proper acceleration are in the sensor frame, with the sensor's noise. The
    orientation is relative to the world (REP 145). Source: imu_sensor_broadcaster,
    imu_sensor_controller.
    """

    types: ClassVar[tuple[str, ...]] = (
        "imu_sensor_broadcaster/IMUSensorBroadcaster",
        "imu_sensor_controller/ImuSensorController",
    )
    kind = "imu"
    message = "sensor_msgs/msg/Imu"
    topic = "imu"

    def read_settings(self, settings: Settings) -> None:
        self._covariances = [
            _nine(settings, f"static_covariance_{what}")
            for what in ("orientation", "angular_velocity", "linear_acceleration")
        ]

    def measure(self, sensed: RobotSensor, head: Any) -> Any:
        assert isinstance(sensed.unit, InertialUnit)
        return imu_message(head, *sensed.unit.measure(), self._covariances)


class ForceTorqueBroadcaster(_SensorBroadcaster):
    """Publishes the wrench that a joint's child link exerts on its parent, as WrenchStamped.

    By default the wrench is in the child link's frame. The sensor's ``<frame>``,
    ``<measure_direction>`` and noise are applied. The topic is ``wrench`` below the controller's
    name in ROS 2, and the sensor's name in ROS 1. Source: force_torque_sensor_broadcaster,
    force_torque_sensor_controller.
    """

    types: ClassVar[tuple[str, ...]] = (
        "force_torque_sensor_broadcaster/ForceTorqueSensorBroadcaster",
        "force_torque_sensor_controller/ForceTorqueSensorController",
    )
    kind = "force_torque"
    message = WRENCH_STAMPED
    topic = "wrench"

    def read_settings(self, settings: Settings) -> None:
        settings.ignore("interface_names")
        names = [f"{what}/{axis}" for what in ("force", "torque") for axis in "xyz"]
        self._offsets = [settings.number(f"offset/{name}", 0.0) for name in names]
        self._factors = [settings.number(f"multiplier/{name}", 1.0) for name in names]

    def measure(self, sensed: RobotSensor, head: Any) -> Any:
        assert isinstance(sensed.unit, JointLoad)
        values = [
            factor * value + offset
            for value, factor, offset in zip(
                sensed.unit.measure(), self._factors, self._offsets, strict=True
            )
        ]
        return wrench_stamped(head, values)


def _nine(settings: Settings, name: str) -> Array:
    values = settings.numbers(name, [0.0] * 9)
    if len(values) != 9:
        raise settings.invalid(name, values, "9 numbers")
    return np.array(values)
