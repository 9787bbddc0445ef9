"""``libgazebo_ros_block_laser.so``: a multi-row laser that publishes point clouds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.rays.lidar import Lidar, LidarConfig
from cartwheel.devices.rays.outputs import PointCloudOutput
from cartwheel.dialects.plugin import Plugin
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
    frame: str = tag(
        "frameName",
        "frame_name",
        default="",
        role="frame",
        doc="Frame ID of the messages. Default: the sensor's link.",
    )
    noise: float = tag(
        "gaussianNoise",
        default=0.0,
        unit="m",
        least=0.0,
        doc="Standard deviation of the noise on each coordinate.",
    )
    least_intensity: float = tag(
        "hokuyoMinIntensity",
        default=101.0,
        doc="No effect, as in Gazebo.",
    )
    update_rate: float = tag(
        "updateRate",
        "update_rate",
        default=0.0,
        unit="Hz",
        doc="No effect: the sensor's `<update_rate>` applies.",
    )


class BlockLaser(Plugin[BlockLaserParameters]):
    """Publishes the points that the rays of a ray sensor hit, as PointCloud messages.

    In the sensor's frame, x points forward, y left and z up. A ray without a hit adds no point to
    the point cloud. Original plugin: ``gazebo_ros_block_laser`` in the package ``gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_block_laser.so",)
    parameters: ClassVar[type] = BlockLaserParameters
    for_sensor: ClassVar[bool] = True
    sensor_type: ClassVar[str] = "ray"

    def configure(self) -> None:
        assert self.sensor is not None
        config = LidarConfig(
            scanner=read_scanner(self.sensor, self.part.report),
            frame=self.config.frame or self.sensor.link,
            outputs=(PointCloudOutput(topic=self.config.topic, noise=self.config.noise),),
        )
        self.add(Lidar(self.scope, config))
