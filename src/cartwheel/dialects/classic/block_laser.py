"""``libgazebo_ros_block_laser.so``: a multi-row laser that publishes point clouds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from cartwheel.devices.point_clouds import point_cloud
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.scan import Scanner
from cartwheel.dialects.tags import tag
from cartwheel.messages import header


@dataclass(frozen=True, kw_only=True, slots=True)
class BlockLaserParameters:
    topic: str = tag(
        "topicName", "topic_name", default="points", doc="Topic of the PointCloud messages."
    )
    frame: str = tag(
        "frameName",
        "frame_name",
        default="",
        doc="Frame ID of the messages. Default: the sensor's link.",
    )
    noise: float = tag(
        "gaussianNoise",
        default=0.0,
        unit="m",
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
        doc="No effect: the sensor's `<update_rate>` is used.",
    )


class BlockLaser(Plugin[BlockLaserParameters]):
    """Publishes the points hit by a ray sensor as a PointCloud.

    Points have x forward, y left and z up. The point cloud contains only the points that were hit.
    Original plugin: ``gazebo_ros_block_laser`` in the package ``gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_block_laser.so",)
    parameters: ClassVar[type] = BlockLaserParameters
    for_sensor: ClassVar[bool] = True
    sensor_type: ClassVar[str] = "ray"

    def configure(self) -> None:
        assert self.sensor is not None
        self.check_not_negative("noise")
        self._scanner = Scanner(self.part, self.sensor)
        self._frame = self.frame(self.config.frame or self.sensor.link)
        rate = self.sensor.update_rate
        self._publisher = self.advertise(
            self.config.topic, "sensor_msgs/msg/PointCloud", rate=rate or None, qos="sensor"
        )
        self.part.schedule(rate, after=self._publish, active=lambda: self._publisher.wanted)

    def _publish(self) -> None:
        scan = self._scanner.measure()
        hit = np.isfinite(scan.ranges)
        points = scan.points(self._scanner.directions)
        if self.config.noise > 0:
            random = self._scanner.random("points")
            points = points + random.normal(0.0, self.config.noise, points.shape)
        moment = header(self.part.time_ns, self._frame)
        self._publisher.publish(point_cloud(moment, points[hit], scan.intensities[hit]))
