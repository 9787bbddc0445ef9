"""``libhector_gazebo_ros_sonar.so``: an ultrasonic range finder with a drift."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.rays.range import RangeFinder, RangeFinderConfig
from cartwheel.dialects.common_tags import deviation_tag, sensor_frame_tag, sensor_rate_tag
from cartwheel.dialects.drift_tags import frequency_tag
from cartwheel.dialects.plugin import SensorPlugin
from cartwheel.dialects.sdf.rates import slowest
from cartwheel.dialects.sdf.scan import read_scanner
from cartwheel.dialects.tags import tag


@dataclass(frozen=True, kw_only=True, slots=True)
class SonarParameters:
    topic: str = tag("topicName", default="sonar", doc="Topic of the Range messages.")
    frame: str = sensor_frame_tag("frameId", "frameName")
    noise: float | None = tag(
        "gaussianNoise",
        default=None,
        unit="m",
        least=0.0,
        doc="Standard deviation of the noise. Default: the sensor's `<noise>`.",
    )
    offset: float = tag("offset", default=0.0, unit="m", doc="Offset added to each range.")
    drift: float = deviation_tag("drift", unit="m", of="a slow drift")
    drift_frequency: float = frequency_tag("driftFrequency", default=0.0)
    update_rate: float = sensor_rate_tag("updateRate", least=0.0)


class HectorSonar(SensorPlugin[SonarParameters]):
    """Publishes the smallest range that a ray sensor measures, as an ultrasound Range message.

    If no ray hits an object, the maximum range is published. Original plugin: ``gazebo_ros_sonar``
    in the package ``hector_gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libhector_gazebo_ros_sonar.so",)
    sensor_type: ClassVar[str] = "ray"

    def configure(self) -> None:
        sensor, config = self.sensor, self.config
        scanner = read_scanner(sensor, self.part.report)
        device = RangeFinderConfig(
            scanner=scanner,
            topic=config.topic,
            frame=config.frame or sensor.link,
            rate=slowest(config.update_rate, sensor.update_rate),
            fov=min(scanner.pattern.field_of_view),
            infrared=False,
            noise=config.noise,
            offset=config.offset,
            drift=config.drift,
            drift_frequency=config.drift_frequency,
        )
        self.add(RangeFinder(self.scope, device))
