"""``libgazebo_ros_range.so``: the distance to the nearest object."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal

from cartwheel.devices.rays.range import RangeFinder, RangeFinderConfig
from cartwheel.dialects.common_tags import sensor_frame_tag, sensor_rate_tag
from cartwheel.dialects.plugin import SensorPlugin
from cartwheel.dialects.sdf.rates import slowest
from cartwheel.dialects.sdf.scan import read_scanner
from cartwheel.dialects.tags import tag


@dataclass(frozen=True, kw_only=True, slots=True)
class RangeParameters:
    topic: str = tag(
        "topicName",
        "topic_name",
        default="/range",
        role="topic",
        doc="Topic of the Range messages.",
    )
    frame: str = sensor_frame_tag("frameName", "frame_name")
    fov: float = tag(
        "fov",
        default=0.05,
        unit="rad",
        doc="Field of view that the messages contain. It does not change the measurement.",
    )
    radiation: Literal["ultrasound", "infrared"] = tag(
        "radiation", default="ultrasound", doc="Radiation type that the messages contain."
    )
    noise: float | None = tag(
        "gaussianNoise",
        default=None,
        unit="m",
        least=0.0,
        doc="Standard deviation of the noise. Default: the sensor's `<noise>`.",
    )
    update_rate: float = sensor_rate_tag("updateRate", "update_rate", least=0.0)


class Range(SensorPlugin[RangeParameters]):
    """Publishes the smallest range that a ray sensor measures, as Range messages.

    If no ray hits an object, the maximum range is published. Original plugin: ``gazebo_ros_range``
    in the package ``gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_range.so",)
    sensor_type: ClassVar[str] = "ray"

    def configure(self) -> None:
        sensor, config = self.sensor, self.config
        device = RangeFinderConfig(
            scanner=read_scanner(sensor, self.part.report),
            topic=config.topic,
            frame=config.frame or sensor.link,
            rate=slowest(config.update_rate, sensor.update_rate),
            fov=config.fov,
            infrared=config.radiation == "infrared",
            # Gazebo ignores the sensor's own noise. Here it applies unless the plugin states noise.
            noise=config.noise,
        )
        self.add(RangeFinder(self.scope, device))
