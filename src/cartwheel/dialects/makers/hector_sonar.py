"""``libhector_gazebo_ros_sonar.so``: an ultrasonic range finder with a drift."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.rays.range import RangeFinder, RangeFinderConfig
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.sdf.rates import slowest
from cartwheel.dialects.sdf.scan import read_scanner
from cartwheel.dialects.tags import tag


@dataclass(frozen=True, kw_only=True, slots=True)
class SonarParameters:
    topic: str = tag("topicName", default="sonar", doc="Topic of the Range messages.")
    frame: str = tag(
        "frameId",
        "frameName",
        default="",
        role="frame",
        doc="Frame ID of the messages. Default: the sensor's link.",
    )
    noise: float | None = tag(
        "gaussianNoise",
        default=None,
        unit="m",
        least=0.0,
        doc="Standard deviation of the noise. Default: the sensor's `<noise>`.",
    )
    offset: float = tag("offset", default=0.0, unit="m", doc="Offset added to each range.")
    drift: float = tag(
        "drift", default=0.0, unit="m", least=0.0, doc="Standard deviation of a slow drift."
    )
    drift_frequency: float = tag(
        "driftFrequency",
        default=0.0,
        unit="1/s",
        least=0.0,
        doc="Inverse of the drift's time constant.",
    )
    update_rate: float = tag(
        "updateRate",
        default=0.0,
        unit="Hz",
        least=0.0,
        doc="Publish rate, limited to the sensor's `<update_rate>`. If 0, the sensor's rate "
        "applies.",
    )


class HectorSonar(Plugin[SonarParameters]):
    """Publishes the smallest range that a ray sensor measures, as an ultrasound Range message.

    If no ray hits an object, the maximum range is published. Original plugin: ``gazebo_ros_sonar``
    in the package ``hector_gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libhector_gazebo_ros_sonar.so",)
    parameters: ClassVar[type] = SonarParameters
    for_sensor: ClassVar[bool] = True
    sensor_type: ClassVar[str] = "ray"

    def configure(self) -> None:
        sensor, config = self.sensor, self.config
        assert sensor is not None
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
