"""``air_pressure`` sensors: barometers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.noise import VectorNoise
from cartwheel.dialects.gz.sensor_tags import default_topic, frame_tag
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.sdf.noise import read_noise
from cartwheel.dialects.tags import number, tag
from cartwheel.messages import header, message_class

SEA_LEVEL = 101325.0
"""Pressure at sea level, Pa."""
TEMPERATURE = 288.15
"""Temperature at sea level, K."""
LAPSE = 0.0065
"""Decrease of the temperature with height, K/m."""
EXPONENT = 9.80665 * 0.0289644 / (8.31446 * LAPSE)


def pressure_at(height: float) -> float:
    """Returns the air pressure in Pa at a height in m above sea level.

    The formula is that of the International Standard Atmosphere, which is valid up to 11 km. Above
    44 km the result is 0.
    """
    return float(SEA_LEVEL * max(1 - LAPSE * height / TEMPERATURE, 0.0) ** EXPONENT)


@dataclass(frozen=True, kw_only=True, slots=True)
class AirPressureParameters:
    topic: str = tag(
        "topic",
        default="",
        doc="Topic of the FluidPressure messages. Default: "
        "`/world/<world>/model/<model>/link/<link>/sensor/<sensor>/air_pressure`.",
    )
    frame: str = frame_tag()


class AirPressure(Plugin[AirPressureParameters]):
    """Publishes the air pressure at the height of the sensor, in Pa.

    The pressure follows the International Standard Atmosphere. ``<reference_altitude>`` is the
    height of the world's origin above sea level. The noise in the sensor's ``<pressure><noise>`` is
    applied. Original sensor: ``AirPressureSensor`` in gz-sensors.
    """

    filenames: ClassVar[tuple[str, ...]] = ()
    parameters: ClassVar[type] = AirPressureParameters
    for_sensor: ClassVar[bool] = True
    serves: ClassVar[tuple[str, ...]] = ("air_pressure",)

    def configure(self) -> None:
        sensor, part = self.sensor, self.part
        assert sensor is not None
        self._link, self._mount = part.link(sensor.link), sensor.pose.position
        self._frame = self.frame(self.config.frame or sensor.link)
        reference = sensor.element.find("air_pressure/reference_altitude")
        self._reference = number(reference) if reference is not None else 0.0
        noise = read_noise(sensor.element.find("air_pressure/pressure/noise"), part.report)
        self._noise = VectorNoise(
            part, f"pressure {sensor.link} {sensor.name}", [noise], rate=sensor.update_rate
        )
        self._FluidPressure = message_class("sensor_msgs/msg/FluidPressure")
        topic = self.config.topic or default_topic(part, sensor, "air_pressure")
        rate = sensor.update_rate
        self._publisher = self.advertise(
            topic, "sensor_msgs/msg/FluidPressure", rate=rate or None, qos="sensor"
        )
        part.schedule(rate, after=self._measure, active=lambda: self._publisher.wanted)

    def _measure(self) -> None:
        _, _, height = self._link.pose.apply(self._mount)
        (pressure,) = self._noise.add([pressure_at(self._reference + height)])
        variance = float(self._noise.variance[0])
        self._publisher.publish(
            self._FluidPressure(header(self.part.time_ns, self._frame), pressure, variance)
        )
