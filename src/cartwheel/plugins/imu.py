"""``libgazebo_ros_imu.so`` and ``libgazebo_ros_imu_sensor.so``: inertial measurement units.

Both follow REP 145: rates and proper acceleration in the sensor's axes, gravity's reaction
included, orientation against the world. Gazebo's model plugin turned the rates the wrong
way and left gravity out.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from cartwheel.description.model import Sensor
from cartwheel.geometry import Pose, quat_conjugate, quat_from_rpy, rotate
from cartwheel.messages import header, message_class
from cartwheel.plugins.base import Plugin
from cartwheel.plugins.gz_sensor import default_topic, frame_tag
from cartwheel.plugins.inertial_unit import InertialUnit
from cartwheel.plugins.parameters import tag


@dataclass(frozen=True, kw_only=True, slots=True)
class ImuParameters:
    body: str = tag("bodyName", "body_name", "frame_name", doc="Link that carries it.")
    topic: str = tag("topicName", default="imu", doc="Imu.")
    service: str = tag("serviceName", default="imu_service", doc="Empty service, accepted.")
    frame: str = tag("frameName", default="", doc="Frame of the messages; the link's when empty.")
    noise: float = tag(
        "gaussianNoise",
        default=0.0,
        unit="rad/s, m/s²",
        doc="Standard deviation of rates and accelerations.",
    )
    rpy_offset: tuple[float, float, float] = tag(
        "rpyOffsets", "rpyOffset", default=(0.0, 0.0, 0.0), unit="rad", doc="Mounting."
    )
    xyz_offset: tuple[float, float, float] = tag(
        "xyzOffset", "xyzOffsets", default=(0.0, 0.0, 0.0), unit="m", doc="Mounting."
    )
    update_rate: float = tag(
        "updateRate", "update_rate", default=0.0, unit="Hz", doc="0 is every step."
    )


class ImuBase(Plugin[Any]):
    """Reads a link and publishes what a unit mounted on it measures."""

    with_gravity: ClassVar[bool] = True
    """Whether its acceleration holds gravity's reaction, as an accelerometer's does."""

    def start(
        self,
        *,
        link: str,
        mount: Pose,
        topic: str,
        frame: str,
        noise: float,
        rate: float,
        sensor: Sensor | None = None,
        from_first: bool = False,
    ) -> None:
        self.check_not_negative("update_rate", "noise")
        self._unit = InertialUnit(
            self.part,
            link,
            mount,
            sensor=sensor,
            from_first=from_first,
            origin=self.tag.origin,
        )
        self._frame = self.frame(frame)
        self._noise = noise
        self._Imu = message_class("sensor_msgs/msg/Imu")
        self._Vector3 = message_class("geometry_msgs/msg/Vector3")
        self._Quaternion = message_class("geometry_msgs/msg/Quaternion")
        self._covariance = np.diag([noise**2] * 3).ravel()
        self._orientation_covariance = self._covariance
        self._rate_covariance = self._accel_covariance = self._covariance
        self._orientation_covariance = self._covariance
        if not self._unit.has_orientation:
            # sensor_msgs/Imu: -1 in its first element says that there is none.
            self._orientation_covariance = np.array([-1.0, *[0.0] * 8])
        both = (self._unit.rate_noise, self._unit.acceleration_noise)
        if both[0] is not None and both[1] is not None:
            self._rate_covariance = self._covariance + np.diag(both[0].variance).ravel()
            self._accel_covariance = self._covariance + np.diag(both[1].variance).ravel()
        self._publisher = self.advertise(
            topic, "sensor_msgs/msg/Imu", rate=rate or None, qos="sensor"
        )
        self.part.schedule(rate, after=self._measure, active=lambda: self._publisher.wanted)

    def _blurred(
        self, rate: Sequence[float], acceleration: Sequence[float]
    ) -> tuple[Sequence[float], Sequence[float]]:
        """Both with the errors that a plugin has of its own."""
        return rate, acceleration

    def _measure(self) -> None:
        orientation, rate, acceleration = self._unit.measure()
        if not self.with_gravity:
            fall = rotate(quat_conjugate(orientation), self._unit.gravity)
            acceleration = [a + b for a, b in zip(acceleration, fall, strict=True)]
        if self._noise > 0:
            random = self.part.random(f"imu {self._publisher.topic}")
            rate = (rate + random.normal(0.0, self._noise, 3)).tolist()
            acceleration = (acceleration + random.normal(0.0, self._noise, 3)).tolist()
        rate, acceleration = self._blurred(rate, acceleration)
        Imu, Vector3, Quaternion = self._Imu, self._Vector3, self._Quaternion
        self._publisher.publish(
            Imu(
                header(self.part.time_ns, self._frame),
                Quaternion(*orientation),
                self._orientation_covariance,
                Vector3(*rate),
                self._rate_covariance,
                Vector3(*acceleration),
                self._accel_covariance,
            )
        )


class Imu(ImuBase):
    """An IMU on a link of the model. Source: gazebo_plugins, gazebo_ros_imu; REP 145."""

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_imu.so",)
    parameters: ClassVar[type] = ImuParameters

    def configure(self) -> None:
        config: ImuParameters = self.config
        self.start(
            link=config.body,
            mount=Pose(config.xyz_offset, quat_from_rpy(*config.rpy_offset)),
            topic=config.topic,
            frame=config.frame or config.body,
            noise=config.noise,
            rate=config.update_rate,
        )
        empty = message_class("std_srvs/srv/Empty_Response")
        # Gazebo's accepts the call and does nothing: the simulated unit has no drift to remove.
        self.serve(config.service, "std_srvs/srv/Empty", lambda _: empty())


@dataclass(frozen=True, kw_only=True, slots=True)
class ImuSensorParameters:
    topic: str = tag("topicName", "topic", default="imu_data", doc="Imu.")
    body: str = tag("bodyName", default="", doc="Read and ignored: the sensor's link counts.")
    frame: str = tag(
        "frameName", "frame_name", default="", doc="Frame of the messages; the link's when empty."
    )
    noise: float = tag(
        "gaussianNoise",
        default=0.0,
        unit="rad/s, m/s²",
        doc="Standard deviation of rates and accelerations.",
    )
    rpy_offset: tuple[float, float, float] = tag(
        "rpyOffset", "rpyOffsets", default=(0.0, 0.0, 0.0), unit="rad", doc="Mounting."
    )
    xyz_offset: tuple[float, float, float] = tag(
        "xyzOffset", "xyzOffsets", default=(0.0, 0.0, 0.0), unit="m", doc="Mounting."
    )
    update_rate: float = tag(
        "updateRateHZ",
        "updateRate",
        default=0.0,
        unit="Hz",
        doc="The slower of this and the sensor's counts; 0 is the sensor's.",
    )
    initial_orientation: bool = tag(
        "initialOrientationAsReference",
        "initial_orientation_as_reference",
        default=False,
        doc="The orientation is against that at first, not against the world (REP 145).",
    )


class ImuSensor(ImuBase):
    """The plugin of an ``imu`` sensor, with the noise that its ``<imu>`` states.

    In ROS 2's spelling, with ``<ros>``, the topic is ``~/out``, to be remapped. In ROS 1's, in a
    model of a world, it is under the model's name where no ``<robotNamespace>`` is stated. Its
    orientation is against the world, or what the sensor's ``<orientation_reference_frame>`` says.
    Source: gazebo_plugins, gazebo_ros_imu_sensor; REP 145.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_imu_sensor.so",)
    parameters: ClassVar[type] = ImuSensorParameters
    for_sensor: ClassVar[bool] = True

    def configure(self) -> None:
        assert self.sensor is not None
        config: ImuSensorParameters = self.config
        offset = Pose(config.xyz_offset, quat_from_rpy(*config.rpy_offset))
        self.under_model()
        topic = config.topic
        element = self.tag.element
        named = element.find("topicName") or element.find("topic")
        if element.find("ros") is not None and named is None:
            topic = "out" if self.remaps("out") else f"{self.tag.name or 'imu'}/out"
        rates = [each for each in (config.update_rate, self.sensor.update_rate) if each > 0]
        self.start(
            link=self.sensor.link,
            mount=self.sensor.pose @ offset,
            topic=topic,
            frame=config.frame or self.sensor.link,
            noise=config.noise,
            rate=min(rates, default=0.0),
            sensor=self.sensor,
            from_first=config.initial_orientation,
        )


@dataclass(frozen=True, kw_only=True, slots=True)
class GzImuParameters:
    topic: str = tag("topic", default="", doc="Imu; Gazebo's long name when empty.")
    frame: str = frame_tag()


class GzImu(ImuBase):
    """An ``imu`` sensor that needs no plugin, with the noise that its ``<imu>`` states.

    Its orientation is against the world, or what ``<orientation_reference_frame>`` says; none
    where ``<enable_orientation>`` is false.

    Source: gz-sensors, ImuSensor; REP 145.
    """

    filenames: ClassVar[tuple[str, ...]] = ()
    parameters: ClassVar[type] = GzImuParameters
    for_sensor: ClassVar[bool] = True
    serves: ClassVar[tuple[str, ...]] = ("imu",)

    def configure(self) -> None:
        sensor = self.sensor
        assert sensor is not None
        config: GzImuParameters = self.config
        self.start(
            link=sensor.link,
            mount=sensor.pose,
            topic=config.topic or default_topic(self.part, sensor, "imu"),
            frame=config.frame or sensor.link,
            noise=0.0,
            rate=sensor.update_rate,
            sensor=sensor,
        )
