"""Magnetometers in gz-sim, which need no plugin."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.noise import VectorNoiseConfig
from cartwheel.devices.position.magnetometer import Magnetometer, MagnetometerConfig
from cartwheel.dialects.gz.sensor_tags import default_topic, frame_tag
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.sdf.noise import read_noise
from cartwheel.dialects.tags import tag


@dataclass(frozen=True, kw_only=True, slots=True)
class GzMagnetometerParameters:
    topic: str = tag(
        "topic",
        default="",
        doc="Topic of the MagneticField messages. "
        "Default: `/world/<world>/model/<model>/link/<link>/sensor/<sensor>/magnetometer`.",
    )
    frame: str = frame_tag()


class GzMagnetometer(Plugin[GzMagnetometerParameters]):
    """Publishes the world's ``<magnetic_field>`` in the frame of a magnetometer, in tesla.

    The sensor corresponds to ``MagnetometerSensor`` in gz-sensors.
    """

    filenames: ClassVar[tuple[str, ...]] = ()
    parameters: ClassVar[type] = GzMagnetometerParameters
    for_sensor: ClassVar[bool] = True
    serves: ClassVar[tuple[str, ...]] = ("magnetometer",)

    def configure(self) -> None:
        sensor, part = self.sensor, self.part
        assert sensor is not None
        x, y, z = (
            read_noise(sensor.element.find(f"magnetometer/{axis}/noise"), part.report)
            for axis in "xyz"
        )
        device = MagnetometerConfig(
            link=sensor.link,
            mount=sensor.pose.orientation,
            topic=self.config.topic or default_topic(part, sensor, "magnetometer"),
            frame=self.config.frame or sensor.link,
            rate=sensor.update_rate,
            error=VectorNoiseConfig(
                name=f"magnetometer {sensor.link} {sensor.name}",
                noises=(x, y, z),
                rate=sensor.update_rate,
            ),
        )
        self.add(Magnetometer(self.scope, device))
