"""``libgazebo_ros_block_laser.so``: a multi-row laser that publishes point clouds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.rays.lidar import Lidar, LidarConfig
from cartwheel.devices.rays.outputs import PointCloudOutput
from cartwheel.dialects.common_tags import deviation_tag, idle_rate_tag, sensor_frame_tag
from cartwheel.dialects.plugin import SensorPlugin
from cartwheel.dialects.sdf.scan import read_scanner
from cartwheel.dialects.tags import tag


@dataclass(frozen=True, kw_only=True, slots=True)
class BlockLaserParameters:
    topic: str = tag(
        "topicName",
        "topic_name",
        default="points",
        role="topic",
        doc="Topic of the PointCloud messages.",
    )
    frame: str = sensor_frame_tag("frameName", "frame_name")
    noise: float = deviation_tag("gaussianNoise", unit="m", of="the noise on each coordinate")
    least_intensity: float = tag(
        "hokuyoMinIntensity",
        default=101.0,
        doc="No effect, as in Gazebo.",
    )
    update_rate: float = idle_rate_tag("updateRate", "update_rate")


class BlockLaser(SensorPlugin[BlockLaserParameters]):
    """Publishes the points that the rays of a ray sensor hit, as PointCloud messages.

    In the sensor's frame, x points forward, y left and z up. A ray without a hit adds no point to
    the point cloud. Original plugin: ``gazebo_ros_block_laser`` in the package ``gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_block_laser.so",)
    sensor_type: ClassVar[str] = "ray"

    def configure(self) -> None:
        config = LidarConfig(
            scanner=read_scanner(self.sensor, self.part.report),
            frame=self.config.frame or self.sensor.link,
            outputs=(PointCloudOutput(topic=self.config.topic, noise=self.config.noise),),
        )
        self.add(Lidar(self.scope, config))
