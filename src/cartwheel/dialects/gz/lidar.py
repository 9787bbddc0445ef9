"""Lidars in gz-sim, which need no plugin."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from cartwheel.devices.point_clouds import point_cloud2
from cartwheel.dialects.gz.sensor_tags import default_topic
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.scan import Scan, Scanner
from cartwheel.dialects.scan_messages import laser_scan
from cartwheel.dialects.tags import tag
from cartwheel.messages import header

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
        doc="Topic of the LaserScan. The PointCloud2 is published on `<topic>/points`. "
        "Default: `/world/<world>/model/<model>/link/<link>/sensor/<sensor>/scan`.",
    )
    frame: str = tag(
        "gz_frame_id",
        "ignition_frame_id",
        "frame_id",
        default="",
        doc="Frame ID of the messages. Default: the sensor's link.",
    )


class GzLidar(Plugin[GzLidarParameters]):
    """Publishes the middle row of a lidar as a LaserScan, and all rows as a PointCloud2.

    The cloud is organised: it has one row of points for each row of rays, starting with the lowest.
    A ray that hits nothing has a point with infinite coordinates.

    ``gpu_lidar`` and ``gpu_ray`` sensors measure the visual geometry; ``lidar`` and ``ray`` sensors
    measure the collision geometry.

    Original sensor: ``GpuLidarSensor`` in gz-sensors. The message types are the same as in
    ros_gz_bridge.
    """

    filenames: ClassVar[tuple[str, ...]] = ()
    parameters: ClassVar[type] = GzLidarParameters
    for_sensor: ClassVar[bool] = True
    serves: ClassVar[tuple[str, ...]] = ("gpu_lidar", "lidar", "gpu_ray", "ray")

    def configure(self) -> None:
        sensor, config = self.sensor, self.config
        assert sensor is not None
        self._scanner = Scanner(self.part, sensor)
        self._frame = self.frame(config.frame or sensor.link)
        topic = config.topic or default_topic(self.part, sensor, "scan")
        rate = sensor.update_rate
        listed_rate = rate or None
        self._scan = self.advertise(
            topic, "sensor_msgs/msg/LaserScan", rate=listed_rate, qos="sensor"
        )
        self._points = self.advertise(
            f"{topic}/points", "sensor_msgs/msg/PointCloud2", rate=listed_rate, qos="sensor"
        )
        self.part.schedule(
            rate,
            after=self._publish,
            active=lambda: self._scan.wanted or self._points.wanted,
        )

    def _publish(self) -> None:
        moment = header(self.part.time_ns, self._frame)
        scan = self._scanner.measure()
        if self._scan.wanted:
            self._scan.publish(laser_scan(moment, self._scanner.pattern, scan))
        if self._points.wanted:
            cloud = self._cloud(scan)
            dense = bool(np.isfinite(scan.ranges).all())
            self._points.publish(point_cloud2(moment, cloud, dense=dense))

    def _cloud(self, scan: Scan) -> np.ndarray[tuple[int, int], np.dtype[np.void]]:
        rows, columns = scan.ranges.shape
        cloud = np.zeros((rows, columns), dtype=_POINT)
        places = scan.points(self._scanner.directions)
        for index, name in enumerate("xyz"):
            cloud[name] = places[..., index]
        cloud["intensity"] = scan.intensities
        cloud["ring"] = np.arange(rows)[:, None]
        return cloud
