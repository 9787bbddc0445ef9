"""Barometers in gz-sim, which need no plugin."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.position.barometer import PressureSensor, PressureSensorConfig
from cartwheel.dialects.gz.sensor_tags import GzSensor, frame_tag, topic_tag
from cartwheel.dialects.tags import number_at


@dataclass(frozen=True, kw_only=True, slots=True)
class AirPressureParameters:
    topic: str = topic_tag("FluidPressure", "air_pressure")
    frame: str = frame_tag()


class AirPressure(GzSensor[AirPressureParameters]):
    """Publishes the air pressure at the height of the sensor, in Pa.

    The pressure follows the International Standard Atmosphere. ``<reference_altitude>`` is the
    height of the world's origin above sea level. The noise in ``<pressure><noise>`` is added. The
    sensor corresponds to ``AirPressureSensor`` in gz-sensors.
    """

    serves: ClassVar[tuple[str, ...]] = ("air_pressure",)

    def configure(self) -> None:
        sensor = self.sensor
        device = PressureSensorConfig(
            link=sensor.link,
            mount=sensor.pose.position,
            elevation=number_at(sensor.element, "air_pressure/reference_altitude"),
            topic=self.topic("air_pressure"),
            frame=self.frame_id,
            rate=sensor.update_rate,
            error=self.noise("pressure", "air_pressure/pressure"),
        )
        self.add(PressureSensor(self.scope, device))
