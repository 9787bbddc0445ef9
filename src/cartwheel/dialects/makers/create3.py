"""The sensors of iRobot's Create 3, the base of the TurtleBot 4, as in Gazebo Classic."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from cartwheel.codes import devices
from cartwheel.devices.bases.hazards import (
    BumperZones,
    BumperZonesConfig,
    CliffSensor,
    CliffSensorConfig,
    WheelDropSensor,
    WheelDropSensorConfig,
)
from cartwheel.devices.bases.infrared import IrIntensity, IrIntensityConfig
from cartwheel.devices.bases.mouse import Mouse, MouseConfig
from cartwheel.devices.inertial.imu import Imu, ImuConfig
from cartwheel.dialects.common_tags import sensor_frame_tag
from cartwheel.dialects.plugin import NoTags, Plugin, SensorPlugin
from cartwheel.dialects.sdf.contact import read_collisions
from cartwheel.dialects.sdf.imu import read_inertial_unit
from cartwheel.dialects.sdf.scan import read_scanner
from cartwheel.dialects.tags import SMALLEST, tag
from cartwheel.errors import PluginError


def out_topic(plugin: Plugin[Any]) -> str:
    """Returns ``~/out``, which tags can remap."""
    return "out" if plugin.remaps("out") else f"{plugin.tag.name}/out"


class Create3Bumper(SensorPlugin[NoTags]):
    """Publishes a HazardDetection of type BUMP while the bumper is pressed.

    The bumper has five zones. The frame ID of a message is the name of the pressed zone, such as
    ``bump_front_left``. If several zones are pressed, the zone with the deepest contact is
    published. Original plugin: ``gazebo_ros_bumper`` in the package
    ``irobot_create_gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_create_bumper.so",)
    sensor_type: ClassVar[str] = "contact"

    def configure(self) -> None:
        device = BumperZonesConfig(
            collisions=read_collisions(self, self.sensor),
            topic=out_topic(self),
            rate=self.sensor.update_rate,
        )
        self.add(BumperZones(self.scope, device))


@dataclass(frozen=True, kw_only=True, slots=True)
class Create3CliffParameters:
    threshold: float = tag(
        "detection_threshold",
        default=0.01,
        unit="m",
        doc="Distance between the sensor and the floor at which a cliff is reported.",
    )
    frame: str = tag("frame_id", default="", doc="Frame ID of the messages. Default: empty.")


class Create3Cliff(SensorPlugin[Create3CliffParameters]):
    """Publishes a HazardDetection of type CLIFF while the floor is too far below a ray sensor.

    The distance to the floor is the smallest range that the sensor measures. Original plugin:
    ``gazebo_ros_cliff_sensor`` in the package ``irobot_create_gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_create_cliff_sensor.so",)
    sensor_type: ClassVar[str] = "ray"

    def configure(self) -> None:
        device = CliffSensorConfig(
            scanner=read_scanner(self.sensor, self.part.report),
            threshold=self.config.threshold,
            topic=out_topic(self),
            frame=self.config.frame,
            rate=self.sensor.update_rate,
        )
        self.add(CliffSensor(self.scope, device))


@dataclass(frozen=True, kw_only=True, slots=True)
class Create3IntensityParameters:
    frame: str = sensor_frame_tag("frame_name")


class Create3Intensity(SensorPlugin[Create3IntensityParameters]):
    """Publishes the intensity of the infrared light that the nearest obstacle reflects.

    The intensity is ``3500 exp(-2 e d / max)``, where e is Euler's number, d is the distance to the
    nearest obstacle and max is the maximum range of the ray sensor. Original plugin:
    ``gazebo_ros_ir_intensity_sensor`` in the package ``irobot_create_gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_create_ir_intensity_sensor.so",)
    sensor_type: ClassVar[str] = "ray"

    def configure(self) -> None:
        sensor = self.sensor
        scanner = read_scanner(sensor, self.part.report)
        if math.isinf(scanner.pattern.maximum):
            raise PluginError(
                "the <max> of the <range> must be finite",
                code=devices.SENSOR_RANGE_INVALID,
                origin=sensor.origin,
            )
        device = IrIntensityConfig(
            scanner=scanner,
            topic=out_topic(self),
            frame=self.config.frame or sensor.link,
            rate=sensor.update_rate,
        )
        self.add(IrIntensity(self.scope, device))


@dataclass(frozen=True, kw_only=True, slots=True)
class Create3ImuParameters:
    frame: str = sensor_frame_tag("frame_name")


class Create3Imu(SensorPlugin[Create3ImuParameters]):
    """Publishes the measurements of an IMU sensor. The acceleration does not include gravity.

    Original plugin: ``gazebo_ros_imu`` in the package ``irobot_create_gazebo_plugins``, which does
    not include gravity either.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_create_imu.so",)
    sensor_type: ClassVar[str] = "imu"

    def configure(self) -> None:
        sensor = self.sensor
        device = ImuConfig(
            unit=read_inertial_unit(self.part, sensor),
            topic=out_topic(self),
            frame=self.config.frame or sensor.link,
            rate=sensor.update_rate,
            gravity=False,
        )
        self.add(Imu(self.scope, device))


@dataclass(frozen=True, kw_only=True, slots=True)
class Create3MouseParameters:
    link: str = tag("link_name", role="link", doc="Link whose travel is measured.")
    rate: float = tag("update_rate", default=62.0, unit="Hz", least=SMALLEST, doc="Publish rate.")


class Create3Mouse(Plugin[Create3MouseParameters]):
    """Publishes the distance, in m, that a link has travelled along its own x and y axes.

    Original plugin: ``gazebo_ros_optical_mouse`` in the package ``irobot_create_gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_create_optical_mouse.so",)

    def configure(self) -> None:
        config = self.config
        device = MouseConfig(link=config.link, topic=out_topic(self), rate=config.rate)
        self.add(Mouse(self.scope, device))


@dataclass(frozen=True, kw_only=True, slots=True)
class Create3WheelDropParameters:
    joint: str = tag("joint_name", role="other_joint", doc="Suspension joint of the wheel.")
    threshold: float = tag(
        "detection_threshold",
        default=0.7,
        unit="m",
        least=SMALLEST,
        doc="Joint position of a fully dropped wheel. The plugin reports a wheel drop from the "
        "time when the position reaches 95 % of this value until it falls below 75 %.",
    )
    frame: str = tag("frame_id", default="", doc="Frame ID of the messages. Default: empty.")
    rate: float = tag(
        "update_rate",
        default=62.0,
        unit="Hz",
        least=SMALLEST,
        doc="Rate at which the joint is checked and messages are published.",
    )


class Create3WheelDrop(Plugin[Create3WheelDropParameters]):
    """Publishes a HazardDetection of type WHEEL_DROP while a wheel is dropped.

    A wheel drops when its suspension joint extends, for example when the robot is lifted. Original
    plugin: ``gazebo_ros_wheel_drop`` in the package ``irobot_create_gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_create_wheel_drop.so",)

    def configure(self) -> None:
        config = self.config
        device = WheelDropSensorConfig(
            joint=config.joint,
            threshold=config.threshold,
            topic=out_topic(self),
            frame=config.frame,
            rate=config.rate,
        )
        self.add(WheelDropSensor(self.scope, device))
