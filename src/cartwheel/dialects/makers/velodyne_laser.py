"""``libgazebo_ros_velodyne_laser.so`` and its GPU variant: lidars with many rings."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from cartwheel.codes import devices
from cartwheel.devices.rays.lidar import Lidar, LidarConfig
from cartwheel.devices.rays.outputs import PointCloud2Output
from cartwheel.dialects.common_tags import idle_rate_tag, sensor_frame_tag
from cartwheel.dialects.plugin import SensorPlugin
from cartwheel.dialects.sdf.scan import read_scanner
from cartwheel.dialects.tags import tag
from cartwheel.errors import PluginError

_POINT = np.dtype(
    [
        ("x", "<f4"),
        ("y", "<f4"),
        ("z", "<f4"),
        ("intensity", "<f4"),
        ("ring", "<u2"),
        ("time", "<f4"),
    ]
)
"""Point layout of the velodyne driver: 22 bytes."""


@dataclass(frozen=True, kw_only=True, slots=True)
class VelodyneParameters:
    topic: str = tag(
        "topicName",
        "topic_name",
        default="/points",
        doc="Topic of the PointCloud2 messages. A `<remapping>` of `~/out` takes precedence.",
    )
    frame: str = sensor_frame_tag("frameName", "frame_name")
    organize: bool = tag(
        "organize_cloud",
        default=False,
        doc="Whether to publish an organised cloud: each column of rays is a row of the cloud, "
        "and rays without a hit result in NaN points.",
    )
    min_range: float = tag(
        "min_range", default=0.0, unit="m", doc="Points closer than this are omitted."
    )
    max_range: float = tag(
        "max_range", default=math.inf, unit="m", doc="Points farther than this are omitted."
    )
    min_intensity: float | None = tag(
        "min_intensity", default=None, doc="Points with a lower intensity are omitted."
    )
    noise: float = tag(
        "gaussianNoise",
        "gaussian_noise",
        default=0.0,
        unit="m",
        least=0.0,
        doc="Standard deviation of the noise on ranges. It is added to the sensor's own noise.",
    )
    update_rate: float = idle_rate_tag("updateRate", "update_rate")


class VelodyneLaser(SensorPlugin[VelodyneParameters]):
    """Publishes the points that a ray sensor hits as PointCloud2, with intensity and ring number.

    Ring 0 is the lowest ring. Points are ordered column by column. All points are measured at the
    same time, so their ``time`` is 0.

    Original plugin: ``GazeboRosVelodyneLaser`` in ``velodyne_simulator``.
    """

    filenames: ClassVar[tuple[str, ...]] = (
        "libgazebo_ros_velodyne_laser.so",
        "libgazebo_ros_velodyne_gpu_laser.so",
    )
    sensor_type: ClassVar[str] = "ray"
    prefixes_by_namespace: ClassVar[bool] = True

    def configure(self) -> None:
        sensor, config = self.sensor, self.config
        scanner = read_scanner(sensor, self.part.report)
        nearest = max(config.min_range, scanner.pattern.minimum)
        furthest = min(config.max_range, scanner.pattern.maximum)
        if nearest >= furthest:
            raise PluginError(
                f"the minimum range of {nearest:g} m must be below the maximum range of "
                f"{furthest:g} m",
                code=devices.PLUGIN_RANGE_REVERSED,
                origin=self.tag.origin,
                values={"parameter": "min_range", "value": nearest, "most": furthest},
                hint="Choose <min_range> and <max_range> within the sensor's <range>.",
            )
        output = PointCloud2Output(
            topic="out" if self.remaps("out") else config.topic,
            layout=_POINT,
            missing="nan" if config.organize else "omit",
            by_column=True,
            nearest=nearest,
            furthest=furthest,
            least_intensity=config.min_intensity,
            noise=config.noise,
        )
        device = LidarConfig(scanner=scanner, frame=config.frame or sensor.link, outputs=(output,))
        self.add(Lidar(self.scope, device))
