"""Lidars in gz-sim, which need no plugin."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from cartwheel.devices.rays.lidar import Lidar, LidarConfig
from cartwheel.devices.rays.outputs import LaserScanOutput, PointCloud2Output
from cartwheel.dialects.gz.sensor_tags import GzSensor, frame_tag
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
    frame: str = frame_tag("frame_id")


class GzLidar(GzSensor[GzLidarParameters]):
    """Publishes a lidar's middle row of rays as a LaserScan, and all rows as a PointCloud2.

    The point cloud is organised: it has one row of points for each row of rays, starting with the
    lowest row. A ray without a hit results in a point with infinite coordinates.

    ``gpu_lidar`` and ``gpu_ray`` sensors detect visual shapes; ``lidar`` and ``ray`` sensors detect
    collision shapes.

    The sensor corresponds to ``GpuLidarSensor`` in gz-sensors. The message types are the same as in
    ros_gz_bridge.
    """

    serves: ClassVar[tuple[str, ...]] = ("gpu_lidar", "lidar", "gpu_ray", "ray")

    def configure(self) -> None:
        sensor = self.sensor
        scanner = read_scanner(sensor, self.part.report)
        topic = self.topic("scan")
        device = LidarConfig(
            scanner=scanner,
            frame=self.frame_id,
            outputs=(
                LaserScanOutput(topic=topic),
                PointCloud2Output(topic=f"{topic}/points", layout=_POINT, missing="inf"),
            ),
        )
        self.add(Lidar(self.scope, device))
