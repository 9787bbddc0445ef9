"""``libgazebo_ros_velodyne_laser.so`` and its GPU variant: lidars with many rings."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from cartwheel.codes import devices
from cartwheel.devices.point_clouds import point_cloud2
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.scan import Scanner
from cartwheel.dialects.tags import tag
from cartwheel.errors import PluginError
from cartwheel.messages import header

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
    frame: str = tag(
        "frameName",
        "frame_name",
        default="",
        doc="Frame ID of the messages. Default: the sensor's link.",
    )
    organize: bool = tag(
        "organize_cloud",
        default=False,
        doc="Publish an organised cloud: each column of rays is a row of the cloud, and missing "
        "points are NaN.",
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
        doc="Standard deviation of the noise on ranges. It is added to the sensor's own noise.",
    )
    update_rate: float = tag(
        "updateRate",
        "update_rate",
        default=0.0,
        unit="Hz",
        doc="No effect: the sensor's `<update_rate>` applies.",
    )


class VelodyneLaser(Plugin[VelodyneParameters]):
    """Publishes the points that a ray sensor hits as a PointCloud2 with intensity and ring.

    Ring 0 is the lowest ring. Points are ordered column by column. All points are measured at the
    same time, so their ``time`` is 0.

    Original plugin: ``GazeboRosVelodyneLaser`` in ``velodyne_simulator``.
    """

    filenames: ClassVar[tuple[str, ...]] = (
        "libgazebo_ros_velodyne_laser.so",
        "libgazebo_ros_velodyne_gpu_laser.so",
    )
    parameters: ClassVar[type] = VelodyneParameters
    for_sensor: ClassVar[bool] = True
    sensor_type: ClassVar[str] = "ray"
    prefixes_by_namespace: ClassVar[bool] = True

    def configure(self) -> None:
        sensor, config = self.sensor, self.config
        assert sensor is not None
        self.check_not_negative("noise")
        self._scanner = Scanner(self.part, sensor)
        pattern = self._scanner.pattern
        self._near = max(config.min_range, pattern.minimum)
        self._far = min(config.max_range, pattern.maximum)
        if self._near >= self._far:
            raise PluginError(
                f"the minimum range of {self._near:g} m must be below the maximum range of "
                f"{self._far:g} m",
                code=devices.PLUGIN_RANGE_REVERSED,
                origin=self.tag.origin,
                values={"parameter": "min_range", "value": self._near, "most": self._far},
                hint="Choose <min_range> and <max_range> within the sensor's <range>.",
            )
        self._frame = self.frame(config.frame or sensor.link)
        rate = sensor.update_rate
        self._publisher = self.advertise(
            "out" if self.remaps("out") else config.topic,
            "sensor_msgs/msg/PointCloud2",
            rate=rate or None,
            qos="sensor",
        )
        self.part.schedule(rate, after=self._publish, active=lambda: self._publisher.wanted)

    def _publish(self) -> None:
        config = self.config
        scan = self._scanner.measure()
        ranges = scan.ranges
        kept = (ranges > self._near) & (ranges < self._far)
        if config.min_intensity is not None:
            kept &= scan.intensities >= config.min_intensity
        if config.noise > 0:
            ranges = ranges + self._scanner.random("points").normal(0.0, config.noise, ranges.shape)
            kept &= (ranges > self._near) & (ranges < self._far)
        rows, columns = ranges.shape
        places = self._scanner.directions * np.where(kept, ranges, np.nan)[..., None]
        cloud = np.zeros((columns, rows), dtype=_POINT)
        for index, name in enumerate("xyz"):
            cloud[name] = places[..., index].T
        cloud["intensity"] = np.where(kept, scan.intensities, np.nan).T
        cloud["ring"] = np.arange(rows)
        if not config.organize:
            cloud = cloud[kept.T]
        moment = header(self.part.time_ns, self._frame)
        self._publisher.publish(point_cloud2(moment, cloud, dense=not config.organize))
