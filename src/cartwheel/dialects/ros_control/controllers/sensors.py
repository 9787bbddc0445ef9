"""Sensor broadcasters: IMU and force-torque."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from cartwheel.codes import running
from cartwheel.devices.contact.loads import JointLoad
from cartwheel.devices.contact.wrench import WRENCH_STAMPED, wrench_stamped
from cartwheel.devices.inertial.messages import imu_message
from cartwheel.devices.inertial.unit import InertialUnit
from cartwheel.devices.periodic import Periodic
from cartwheel.dialects.ros_control.controller import Controller
from cartwheel.dialects.ros_control.parameters import ignored, parameter, ros2_parameter
from cartwheel.dialects.ros_control.robot import RobotSensor
from cartwheel.dialects.ros_control.settings import Settings
from cartwheel.errors import UnknownNameError
from cartwheel.graph import Publisher
from cartwheel.messages import header


@dataclass(frozen=True, kw_only=True, slots=True)
class BroadcasterParameters:
    publish_rate: float | None = parameter(
        "publish_rate", ros2=(), default=None, unit="Hz", doc="Publish rate; required."
    )
    sensor: str = ros2_parameter(
        "sensor_name",
        default="",
        doc="The sensor; can be omitted if the robot has one sensor of this type.",
    )
    frame: str | None = ros2_parameter(
        "frame_id",
        default=None,
        doc="Frame of the messages. Default: the sensor's link.",
    )


def _covariance(what: str) -> Any:
    return parameter(
        f"static_covariance_{what}",
        default=(0.0,) * 9,
        doc=f"Covariance of the {what.replace('_', ' ')}: 9 numbers.",
    )


@dataclass(frozen=True, kw_only=True, slots=True)
class ImuBroadcasterParameters(BroadcasterParameters):
    orientation: tuple[float, ...] = _covariance("orientation")
    angular_velocity: tuple[float, ...] = _covariance("angular_velocity")
    linear_acceleration: tuple[float, ...] = _covariance("linear_acceleration")


def _six(default: float) -> Callable[[Settings], tuple[float, ...]]:
    """Reads the numbers of a force and a torque."""
    names = [f"{what}/{axis}" for what in ("force", "torque") for axis in "xyz"]
    return lambda settings: tuple(settings.number(name, default) for name in names)


@dataclass(frozen=True, kw_only=True, slots=True)
class ForceTorqueBroadcasterParameters(BroadcasterParameters):
    offset: tuple[float, ...] = parameter(
        "offset", read=_six(0.0), doc="Added to the measurement: `force/x` to `torque/z`."
    )
    multiplier: tuple[float, ...] = parameter(
        "multiplier", read=_six(1.0), doc="Factors on the measurement: `force/x` to `torque/z`."
    )
    unused: None = ignored("interface_names")


class _SensorBroadcaster(Controller):
    """Base class of broadcasters, which publish the measurements of one sensor type."""

    kind: ClassVar[str]
    message: ClassVar[str]
    topic: ClassVar[str]

    def configure(self, given: Any) -> None:
        settings = self.settings
        self._outputs: list[tuple[RobotSensor, Publisher, str]] = []
        if given.publish_rate is None and not self.robot.ros2:
            raise settings.missing("publish_rate")
        rate = given.publish_rate or 0.0
        self._periodic = Periodic(rate)
        sensors = [each for each in self.robot.sensors.values() if each.type == self.kind]
        if self.robot.ros2:
            name = given.sensor
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
            frame = chosen.sensor.link if given.frame is None else given.frame
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
        self.calibrate(given)

    def calibrate(self, given: Any) -> None:
        """Uses the parameters of the sensor type."""

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

    parameters = ImuBroadcasterParameters

    def calibrate(self, given: ImuBroadcasterParameters) -> None:
        self._covariances = []
        for what in ("orientation", "angular_velocity", "linear_acceleration"):
            values = getattr(given, what)
            if len(values) != 9:
                raise self.settings.invalid(f"static_covariance_{what}", values, "9 numbers")
            self._covariances.append(np.array(values))

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

    parameters = ForceTorqueBroadcasterParameters

    def calibrate(self, given: ForceTorqueBroadcasterParameters) -> None:
        self._offsets, self._factors = given.offset, given.multiplier

    def measure(self, sensed: RobotSensor, head: Any) -> Any:
        assert isinstance(sensed.unit, JointLoad)
        values = [
            factor * value + offset
            for value, factor, offset in zip(
                sensed.unit.measure(), self._factors, self._offsets, strict=True
            )
        ]
        return wrench_stamped(head, values)
