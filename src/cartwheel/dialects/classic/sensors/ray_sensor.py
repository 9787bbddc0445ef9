"""``libgazebo_ros_ray_sensor.so``: one plugin for scans, point clouds and ranges (ROS 2)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal

from cartwheel.devices.rays.lidar import Lidar, LidarConfig
from cartwheel.devices.rays.outputs import (
    LaserScanOutput,
    Output,
    PointCloud2Output,
    PointCloudOutput,
    RangeOutput,
)
from cartwheel.dialects.common_tags import idle_rate_tag, sensor_frame_tag
from cartwheel.dialects.plugin import SensorPlugin
from cartwheel.dialects.sdf.scan import read_scanner
from cartwheel.dialects.tags import invalid, tag

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
    frame: str = sensor_frame_tag("frame_name", "frameName")
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
        doc="Minimum intensity. Lower intensities are replaced by this value.",
    )
    update_rate: float = idle_rate_tag("updateRate", "update_rate")


class RaySensor(SensorPlugin[RaySensorParameters]):
    """Publishes a ray sensor's ranges as LaserScan, PointCloud, PointCloud2 or Range messages.

    A LaserScan contains the middle row of rays. Point clouds contain no points for rays without a
    hit. A Range is the smallest range of all rays. As in REP 117, it is inf without a hit, and -inf
    if an object is closer than the minimum range.

    Original plugin: ``gazebo_ros_ray_sensor`` in the ROS 2 package ``gazebo_plugins``, with the
    conversions in ``gazebo_ros``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_ray_sensor.so",)
    sensor_type: ClassVar[str] = "ray"

    def configure(self) -> None:
        sensor, config = self.sensor, self.config
        scanner = read_scanner(sensor, self.part.report)
        device = LidarConfig(
            scanner=scanner, frame=config.frame or sensor.link, outputs=(self._output(),)
        )
        self.add(Lidar(self.scope, device))

    def _output(self) -> Output:
        config, floor = self.config, self.config.min_intensity
        topic = "out" if self.remaps("out") else config.topic or f"{self.tag.name}/out"
        match config.output_type.rsplit("/", 1)[-1]:
            case "LaserScan":
                return LaserScanOutput(topic=topic, intensity_floor=floor)
            case "PointCloud":
                return PointCloudOutput(topic=topic, intensity_floor=floor)
            case "PointCloud2":
                return PointCloud2Output(topic=topic, intensity_floor=floor)
            case "Range":
                return RangeOutput(topic=topic, infrared=config.radiation != "ultrasound")
        wanted = f"one of {', '.join(f'sensor_msgs/{name}' for name in _OUTPUTS)}"
        raise invalid("output_type", config.output_type, wanted, self.place_of("output_type"))
