"""``libgazebo_ros_laser.so`` and ``libgazebo_ros_gpu_laser.so``: laser scanners."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.codes import devices
from cartwheel.devices.rays.lidar import Lidar, LidarConfig
from cartwheel.devices.rays.outputs import LaserScanOutput
from cartwheel.dialects.common_tags import idle_rate_tag, sensor_frame_tag
from cartwheel.dialects.plugin import SensorPlugin
from cartwheel.dialects.sdf.scan import read_scanner
from cartwheel.dialects.tags import tag


@dataclass(frozen=True, kw_only=True, slots=True)
class LaserParameters:
    topic: str = tag(
        "topicName", "topic_name", default="scan", role="topic", doc="Topic of the scans."
    )
    frame: str = sensor_frame_tag("frameName", "frame_name")
    update_rate: float = idle_rate_tag("updateRate", "update_rate")


class Laser(SensorPlugin[LaserParameters]):
    """Publishes the ranges that a ray sensor measures, as LaserScan messages.

    As in Gazebo, a ``ray`` sensor detects collision shapes, and a ``gpu_ray`` sensor detects visual
    shapes. All rays are measured simultaneously, so ``time_increment`` and ``scan_time`` are 0. If
    the sensor has several rows of rays, only the middle row is published.

    Original plugins: ``gazebo_ros_laser`` and ``gazebo_ros_gpu_laser`` in the package
    ``gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = (
        "libgazebo_ros_laser.so",
        "libgazebo_ros_gpu_laser.so",
    )
    empty_is_model: ClassVar[bool] = True
    sensor_type: ClassVar[str] = "ray"
    prefixes_by_namespace: ClassVar[bool] = True

    def configure(self) -> None:
        scanner = read_scanner(self.sensor, self.part.report)
        rows = scanner.pattern.vertical.count
        if rows > 1:
            self.warn(
                devices.SENSOR_SETTING_IGNORED,
                f"a LaserScan has a single row, so only the middle row of {rows} is published",
                values={"setting": "vertical", "rows": rows},
            )
        config = LidarConfig(
            scanner=scanner,
            frame=self.config.frame or self.sensor.link,
            outputs=(LaserScanOutput(topic=self.config.topic),),
        )
        self.add(Lidar(self.scope, config))
