"""``libgazebo_ros_imu_sensor.so``: publishes an ``imu`` sensor."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.inertial.imu import Imu, ImuConfig
from cartwheel.dialects.common_tags import (
    deviation_tag,
    position_tag,
    rotation_tag,
    sensor_frame_tag,
    sensor_rate_tag,
)
from cartwheel.dialects.plugin import SensorPlugin
from cartwheel.dialects.sdf.imu import read_inertial_unit
from cartwheel.dialects.sdf.rates import slowest
from cartwheel.dialects.tags import tag
from cartwheel.geometry import Pose, quat_from_rpy


@dataclass(frozen=True, kw_only=True, slots=True)
class ImuSensorParameters:
    topic: str = tag(
        "topicName", "topic", default="imu_data", role="topic", doc="Topic of the Imu messages."
    )
    body: str = tag("bodyName", default="", doc="No effect: the IMU is on the sensor's link.")
    frame: str = sensor_frame_tag("frameName", "frame_name")
    noise: float = deviation_tag(
        "gaussianNoise", unit="rad/s and m/s²", of="the noise on angular velocity and acceleration"
    )
    rpy_offset: tuple[float, float, float] = rotation_tag(
        "rpyOffset", "rpyOffsets", of="the IMU relative to the sensor's pose"
    )
    xyz_offset: tuple[float, float, float] = position_tag(
        "xyzOffset", "xyzOffsets", of="the IMU relative to the sensor's pose"
    )
    update_rate: float = sensor_rate_tag("updateRateHZ", "updateRate", least=0.0)
    initial_orientation: bool = tag(
        "initialOrientationAsReference",
        "initial_orientation_as_reference",
        default=False,
        doc="Whether to publish the orientation relative to the initial orientation instead of "
        "the world (REP 145). The sensor's `<orientation_reference_frame>` takes "
        "precedence.",
    )


class ImuSensor(SensorPlugin[ImuSensorParameters]):
    """Publishes the measurements of an ``imu`` sensor, with the noise specified in its ``<imu>``.

    If the ``<plugin>`` contains ``<ros>``, it is treated as written for ROS 2: the default topic is
    ``~/out``, which a ``<remapping>`` can rename. Otherwise, it is treated as written for ROS 1:
    the topic is in the namespace ``<robotNamespace>``. If this tag is missing and the model is part
    of a world file, the namespace is the model's name.

    The orientation is relative to the world, or to the sensor's ``<orientation_reference_frame>``
    if this tag is set. If ``<enable_orientation>`` is false, the orientation is not measured, and
    the first element of its covariance is -1. Original plugin: ``gazebo_ros_imu_sensor`` in the
    package ``gazebo_plugins``. See also REP 145.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_imu_sensor.so",)
    sensor_type: ClassVar[str] = "imu"

    def configure(self) -> None:
        sensor, config = self.sensor, self.config
        self.under_model()
        offset = Pose(config.xyz_offset, quat_from_rpy(*config.rpy_offset))
        unit = read_inertial_unit(
            self.part,
            sensor,
            mount=sensor.pose @ offset,
            from_first=config.initial_orientation,
        )
        self.add(
            Imu(
                self.scope,
                ImuConfig(
                    unit=unit,
                    topic=self._topic(),
                    frame=config.frame or sensor.link,
                    rate=slowest(config.update_rate, sensor.update_rate),
                    noise=config.noise,
                ),
            )
        )

    def _topic(self) -> str:
        element = self.tag.element
        stated = element.find("topicName") or element.find("topic")
        if element.find("ros") is None or stated is not None:
            return self.config.topic
        return "out" if self.remaps("out") else f"{self.tag.name or 'imu'}/out"
