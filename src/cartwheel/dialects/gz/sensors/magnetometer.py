"""Magnetometers in gz-sim, which need no plugin."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.position.magnetometer import Magnetometer, MagnetometerConfig
from cartwheel.dialects.gz.sensor_tags import GzSensor, frame_tag, topic_tag


@dataclass(frozen=True, kw_only=True, slots=True)
class GzMagnetometerParameters:
    topic: str = topic_tag("MagneticField", "magnetometer")
    frame: str = frame_tag()


class GzMagnetometer(GzSensor[GzMagnetometerParameters]):
    """Publishes the world's ``<magnetic_field>`` in the frame of a magnetometer, in tesla.

    The sensor corresponds to ``MagnetometerSensor`` in gz-sensors.
    """

    serves: ClassVar[tuple[str, ...]] = ("magnetometer",)

    def configure(self) -> None:
        sensor = self.sensor
        device = MagnetometerConfig(
            link=sensor.link,
            mount=sensor.pose.orientation,
            topic=self.topic("magnetometer"),
            frame=self.frame_id,
            rate=sensor.update_rate,
            error=self.noise("magnetometer", *(f"magnetometer/{axis}" for axis in "xyz")),
        )
        self.add(Magnetometer(self.scope, device))
