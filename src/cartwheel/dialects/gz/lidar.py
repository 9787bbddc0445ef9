"""Lidars in gz-sim, which need no plugin."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from cartwheel.devices.rays.lidar import Lidar, LidarConfig
from cartwheel.devices.rays.outputs import LaserScanOutput, PointCloud2Output
from cartwheel.dialects.gz.sensor_tags import default_topic
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.sdf.scan import read_scanner
from cartwheel.dialects.tags import tag

_POINT = np.dtype(
    {
        "names": ["x", "y", "z", "intensity", "ring"],
        "formats": ["<f4", "<f4", "<f4", "<f4", "<u2"],
        "offsets": [0, 4, 8, 16, 24],
        "itemsize": 32,
    }
)
"""Layout as in gz-sensors."""


@dataclass(frozen=True, kw_only=True, slots=True)
class GzLidarParameters:
    topic: str = tag(
        "topic",
        default="",
        doc="Topic of the LaserScan messages. The PointCloud2 messages are published on "
        "`<topic>/points`. Default: "
        "`/world/<world>/model/<model>/link/<link>/sensor/<sensor>/scan`.",
    )
    frame: str = tag(
        "gz_frame_id",
        "ignition_frame_id",
        "frame_id",
        default="",
        doc="Frame ID of the messages. Default: the sensor's link.",
    )


class GzLidar(Plugin[GzLidarParameters]):
    """Publishes a lidar's middle row of rays as a LaserScan, and all rows as a PointCloud2.

    The point cloud is organised: it has one row of points for each row of rays, starting with the
    lowest row. A ray without a hit results in a point with infinite coordinates.

    ``gpu_lidar`` and ``gpu_ray`` sensors detect visual shapes; ``lidar`` and ``ray`` sensors detect
    collision shapes.

    The sensor corresponds to ``GpuLidarSensor`` in gz-sensors. The message types are the same as in
    ros_gz_bridge.
    """

    filenames: ClassVar[tuple[str, ...]] = ()
    parameters: ClassVar[type] = GzLidarParameters
    for_sensor: ClassVar[bool] = True
    serves: ClassVar[tuple[str, ...]] = ("gpu_lidar", "lidar", "gpu_ray", "ray")

    def configure(self) -> None:
        sensor, config = self.sensor, self.config
        assert sensor is not None
        scanner = read_scanner(sensor, self.part.report)
        topic = config.topic or default_topic(self.part, sensor, "scan")
        device = LidarConfig(
            scanner=scanner,
            frame=config.frame or sensor.link,
            outputs=(
                LaserScanOutput(topic=topic),
                PointCloud2Output(topic=f"{topic}/points", layout=_POINT, missing="inf"),
            ),
        )
        self.add(Lidar(self.scope, device))
