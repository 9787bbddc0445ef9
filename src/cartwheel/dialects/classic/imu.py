"""``libgazebo_ros_imu.so`` and ``libgazebo_ros_imu_sensor.so``: inertial measurement units.

Both follow REP 145: angular velocity and proper acceleration (including the reaction to gravity) in
the sensor frame, and orientation relative to the world. Gazebo's model plugin rotates the angular
velocity the wrong way and omits gravity.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from cartwheel.description.model import Sensor
from cartwheel.dialects.gz.sensor_tags import default_topic, frame_tag
from cartwheel.dialects.inertial_unit import InertialUnit
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag
from cartwheel.geometry import Pose, quat_conjugate, quat_from_rpy, rotate
from cartwheel.messages import header, message_class


@dataclass(frozen=True, kw_only=True, slots=True)
class ImuParameters:
    body: str = tag("bodyName", "body_name", "frame_name", doc="Link that carries the IMU.")
    topic: str = tag("topicName", default="imu", doc="Topic of the Imu messages.")
    service: str = tag(
        "serviceName",
        default="imu_service",
        doc="Service of type Empty. Calls succeed and have no effect.",
    )
    frame: str = tag("frameName", default="", doc="Frame ID of the messages. Default: the link.")
    noise: float = tag(
        "gaussianNoise",
        default=0.0,
        unit="rad/s and m/s²",
        doc="Standard deviation of the noise on angular velocity and acceleration.",
    )
    rpy_offset: tuple[float, float, float] = tag(
        "rpyOffsets",
        "rpyOffset",
        default=(0.0, 0.0, 0.0),
        unit="rad",
        doc="Roll, pitch and yaw of the IMU in the link frame.",
    )
    xyz_offset: tuple[float, float, float] = tag(
        "xyzOffset",
        "xyzOffsets",
        default=(0.0, 0.0, 0.0),
        unit="m",
        doc="Position of the IMU in the link frame.",
    )
    update_rate: float = tag(
        "updateRate",
        "update_rate",
        default=0.0,
        unit="Hz",
        doc="Publish rate. 0: every step.",
    )


class ImuBase(Plugin[Any]):
    """Base class of the IMU plugins, which publish the measurements of an IMU on a link."""

    with_gravity: ClassVar[bool] = True
    """Whether the acceleration includes gravity, as measured by an accelerometer."""

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
            # sensor_msgs/Imu: -1 in the first element marks the orientation as not measured.
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
        """Adds the errors of a subclass to angular velocity and acceleration."""
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
    """Publishes angular velocity, acceleration and orientation of an IMU on a link.

    The acceleration includes the reaction to gravity, and both vectors are in the IMU frame (REP
    145). Gazebo's plugin rotates the angular velocity the wrong way and omits gravity. Original
    plugin: ``gazebo_ros_imu`` in the package ``gazebo_plugins``.
    """

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
        # As in Gazebo, calls have no effect: the simulated IMU has no drift to remove.
        self.serve(config.service, "std_srvs/srv/Empty", lambda _: empty())


@dataclass(frozen=True, kw_only=True, slots=True)
class ImuSensorParameters:
    topic: str = tag("topicName", "topic", default="imu_data", doc="Topic of the Imu messages.")
    body: str = tag("bodyName", default="", doc="No effect: the IMU is on the sensor's link.")
    frame: str = tag(
        "frameName",
        "frame_name",
        default="",
        doc="Frame ID of the messages. Default: the sensor's link.",
    )
    noise: float = tag(
        "gaussianNoise",
        default=0.0,
        unit="rad/s and m/s²",
        doc="Standard deviation of the noise on angular velocity and acceleration.",
    )
    rpy_offset: tuple[float, float, float] = tag(
        "rpyOffset",
        "rpyOffsets",
        default=(0.0, 0.0, 0.0),
        unit="rad",
        doc="Roll, pitch and yaw of the IMU relative to the sensor's pose.",
    )
    xyz_offset: tuple[float, float, float] = tag(
        "xyzOffset",
        "xyzOffsets",
        default=(0.0, 0.0, 0.0),
        unit="m",
        doc="Position of the IMU relative to the sensor's pose.",
    )
    update_rate: float = tag(
        "updateRateHZ",
        "updateRate",
        default=0.0,
        unit="Hz",
        doc="Publish rate, at most the sensor's rate. 0: the sensor's rate.",
    )
    initial_orientation: bool = tag(
        "initialOrientationAsReference",
        "initial_orientation_as_reference",
        default=False,
        doc="Publish the orientation relative to the initial orientation instead of the world "
        "(REP 145). The sensor's `<orientation_reference_frame>` takes precedence.",
    )


class ImuSensor(ImuBase):
    """Publishes the measurements of an ``imu`` sensor, with the noise specified in its ``<imu>``.

    With ``<ros>`` (ROS 2), the default topic is ``~/out``, which a ``<remapping>`` can rename.
    Without ``<ros>`` (ROS 1), the topic is in the namespace ``<robotNamespace>``. If this tag is
    missing and the model is part of a world file, the namespace is the model's name.

    The orientation is relative to the world, or to the sensor's ``<orientation_reference_frame>``.
    If ``<enable_orientation>`` is false, the orientation is not measured and the first element of
    its covariance is -1. Original plugin: ``gazebo_ros_imu_sensor`` in the package
    ``gazebo_plugins``. See also REP 145.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_imu_sensor.so",)
    parameters: ClassVar[type] = ImuSensorParameters
    for_sensor: ClassVar[bool] = True
    sensor_type: ClassVar[str] = "imu"

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
    topic: str = tag(
        "topic",
        default="",
        doc="Topic of the Imu messages. Default: "
        "`/world/<world>/model/<model>/link/<link>/sensor/<sensor>/imu`.",
    )
    frame: str = frame_tag()


class GzImu(ImuBase):
    """Publishes the measurements of an ``imu`` sensor, with the noise specified in its ``<imu>``.

    The orientation is relative to the world, or to ``<orientation_reference_frame>``. If
    ``<enable_orientation>`` is false, the orientation is not measured and the first element of its
    covariance is -1.

    Original sensor: ``ImuSensor`` in gz-sensors. See also REP 145.
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
