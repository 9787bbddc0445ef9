"""Altimeters in gz-sim, which need no plugin."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.noise import VectorNoiseConfig
from cartwheel.devices.position import altimeter
from cartwheel.dialects.gz.sensor_tags import default_topic, frame_tag
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.sdf.noise import read_noise
from cartwheel.dialects.tags import tag


@dataclass(frozen=True, kw_only=True, slots=True)
class AltimeterParameters:
    topic: str = tag(
        "topic",
        default="",
        doc="Topic of the Altimeter messages. Default: "
        "`/world/<world>/model/<model>/link/<link>/sensor/<sensor>/altimeter`.",
    )
    frame: str = frame_tag()


class Altimeter(Plugin[AltimeterParameters]):
    """Publishes a sensor's height above its initial position, and its vertical velocity.

    Heights are in m and velocities in m/s. The message field ``vertical_reference`` is the sensor's
    initial z coordinate in the world. The sensor adds the noise in ``<vertical_position>``
    and ``<vertical_velocity>``.

    The sensor corresponds to ``AltimeterSensor`` in gz-sensors. The message type is the same as in
    ros_gz_bridge.
    """

    filenames: ClassVar[tuple[str, ...]] = ()
    parameters: ClassVar[type] = AltimeterParameters
    for_sensor: ClassVar[bool] = True
    serves: ClassVar[tuple[str, ...]] = ("altimeter",)

    def configure(self) -> None:
        sensor, part = self.sensor, self.part
        assert sensor is not None
        height, velocity = (
            read_noise(sensor.element.find(f"altimeter/{name}/noise"), part.report)
            for name in ("vertical_position", "vertical_velocity")
        )
        device = altimeter.AltimeterConfig(
            link=sensor.link,
            mount=sensor.pose.position,
            topic=self.config.topic or default_topic(part, sensor, "altimeter"),
            frame=self.config.frame or sensor.link,
            rate=sensor.update_rate,
            error=VectorNoiseConfig(
                name=f"altimeter {sensor.link} {sensor.name}",
                noises=(height, velocity),
                rate=sensor.update_rate,
            ),
        )
        self.add(altimeter.Altimeter(self.scope, device))
