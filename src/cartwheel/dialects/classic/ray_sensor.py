"""``libgazebo_ros_ray_sensor.so``: one plugin for scans, point clouds and ranges (ROS 2)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np

from cartwheel.devices.point_clouds import point_cloud, point_cloud2
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.scan import Scanner
from cartwheel.dialects.scan_messages import laser_scan, range_reading
from cartwheel.dialects.tags import invalid, tag
from cartwheel.messages import header

_POINT = np.dtype([("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("intensity", "<f4")])
_OUTPUTS = ("LaserScan", "PointCloud", "PointCloud2", "Range")


@dataclass(frozen=True, kw_only=True, slots=True)
class RaySensorParameters:
    output_type: str = tag(
        "output_type",
        "outputType",
        default="sensor_msgs/PointCloud2",
        doc="Message type: `sensor_msgs/LaserScan`, `sensor_msgs/PointCloud`, "
        "`sensor_msgs/PointCloud2` or `sensor_msgs/Range`.",
    )
    topic: str = tag(
        "topicName",
        "topic_name",
        default="",
        doc="Topic of the messages. A `<remapping>` of `~/out` takes precedence. Default: "
        "`<plugin name>/out`.",
    )
    frame: str = tag(
        "frame_name",
        "frameName",
        default="",
        doc="Frame ID of the messages. Default: the sensor's link.",
    )
    radiation: Literal["ultrasound", "infrared", "infared"] = tag(
        "radiation_type",
        "radiationType",
        default="infrared",
        doc="Radiation type of Range messages. The misspelling `infared` is accepted.",
    )
    min_intensity: float = tag(
        "min_intensity",
        "minIntensity",
        default=0.0,
        doc="Intensities below this value are raised to it.",
    )
    update_rate: float = tag(
        "updateRate",
        "update_rate",
        default=0.0,
        unit="Hz",
        doc="No effect: the sensor's `<update_rate>` applies.",
    )


class RaySensor(Plugin[RaySensorParameters]):
    """Publishes the ranges of a ray sensor as LaserScan, PointCloud, PointCloud2 or Range.

    A LaserScan contains the middle row. Point clouds contain only the points that were hit. A Range
    is the minimum over all rays: inf if nothing was hit, -inf if an object is closer than the
    minimum range (REP 117).

    Original plugin: ``gazebo_ros_ray_sensor`` in the ROS 2 package ``gazebo_plugins``, with the
    conversions in ``gazebo_ros``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_ray_sensor.so",)
    parameters: ClassVar[type] = RaySensorParameters
    for_sensor: ClassVar[bool] = True
    sensor_type: ClassVar[str] = "ray"

    def configure(self) -> None:
        sensor, config = self.sensor, self.config
        assert sensor is not None
        self._scanner = Scanner(self.part, sensor)
        self._output = config.output_type.rsplit("/", 1)[-1]
        if self._output not in _OUTPUTS:
            wanted = f"one of {', '.join(f'sensor_msgs/{name}' for name in _OUTPUTS)}"
            place = self.place_of("output_type")
            raise invalid("output_type", config.output_type, wanted, place)
        self._frame = self.frame(config.frame or sensor.link)
        topic = config.topic or f"{self.tag.name}/out"
        rate = sensor.update_rate
        self._publisher = self.advertise(
            "out" if self.remaps("out") else topic,
            f"sensor_msgs/msg/{self._output}",
            rate=rate or None,
            qos="sensor",
        )
        self.part.schedule(rate, after=self._publish, active=lambda: self._publisher.wanted)

    def _publish(self) -> None:
        moment = header(self.part.time_ns, self._frame)
        pattern, scan = self._scanner.pattern, self._scanner.measure()
        floor = self.config.min_intensity
        if self._output == "LaserScan":
            self._publisher.publish(laser_scan(moment, pattern, scan, floor=floor))
            return
        if self._output == "Range":
            self._publisher.publish(
                range_reading(
                    moment,
                    pattern,
                    float(scan.ranges.min()),
                    fov=max(pattern.field_of_view),
                    infrared=self.config.radiation != "ultrasound",
                )
            )
            return
        hit = np.isfinite(scan.ranges)
        points = scan.points(self._scanner.directions)[hit]
        intensities = np.maximum(scan.intensities[hit], floor)
        if self._output == "PointCloud":
            self._publisher.publish(point_cloud(moment, points, intensities))
            return
        cloud = np.empty(len(points), dtype=_POINT)
        for index, name in enumerate("xyz"):
            cloud[name] = points[:, index]
        cloud["intensity"] = intensities
        self._publisher.publish(point_cloud2(moment, cloud, dense=True))
