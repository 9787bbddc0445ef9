"""Barometers in gz-sim, which need no plugin."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.noise import VectorNoiseConfig
from cartwheel.devices.position.barometer import PressureSensor, PressureSensorConfig
from cartwheel.dialects.gz.sensor_tags import default_topic, frame_tag
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.sdf.noise import read_noise
from cartwheel.dialects.tags import number, tag


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
    height of the world's origin above sea level. The noise in ``<pressure><noise>`` is added. The
    sensor corresponds to ``AirPressureSensor`` in gz-sensors.
    """

    filenames: ClassVar[tuple[str, ...]] = ()
    parameters: ClassVar[type] = AirPressureParameters
    for_sensor: ClassVar[bool] = True
    serves: ClassVar[tuple[str, ...]] = ("air_pressure",)

    def configure(self) -> None:
        sensor, part = self.sensor, self.part
        assert sensor is not None
        reference = sensor.element.find("air_pressure/reference_altitude")
        elevation = number(reference) if reference is not None else 0.0
        noise = read_noise(sensor.element.find("air_pressure/pressure/noise"), part.report)
        device = PressureSensorConfig(
            link=sensor.link,
            mount=sensor.pose.position,
            elevation=elevation,
            topic=self.config.topic or default_topic(part, sensor, "air_pressure"),
            frame=self.config.frame or sensor.link,
            rate=sensor.update_rate,
            error=VectorNoiseConfig(
                name=f"pressure {sensor.link} {sensor.name}",
                noises=(noise,),
                rate=sensor.update_rate,
            ),
        )
        self.add(PressureSensor(self.scope, device))
