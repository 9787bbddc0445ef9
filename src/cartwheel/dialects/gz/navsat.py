"""Satellite navigation in gz-sim, which needs no plugin."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.position.gps import Gps
from cartwheel.dialects.gz.sensor_tags import default_topic, frame_tag
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.sdf.gps import read_gps
from cartwheel.dialects.tags import tag


@dataclass(frozen=True, kw_only=True, slots=True)
class GzNavSatParameters:
    topic: str = tag(
        "topic",
        default="",
        doc="Topic of the NavSatFix messages. Default: "
        "`/world/<world>/model/<model>/link/<link>/sensor/<sensor>/navsat`.",
    )
    frame: str = frame_tag()


class GzNavSat(Plugin[GzNavSatParameters]):
    """Publishes the latitude, longitude and altitude that a ``navsat`` sensor measures.

    The world's ``<spherical_coordinates>`` define the geographic position of the world's origin.
    The sensor adds the noise in ``<navsat>``, in m. The sensor corresponds to
    ``NavSatSensor`` in gz-sensors.
    """

    filenames: ClassVar[tuple[str, ...]] = ()
    parameters: ClassVar[type] = GzNavSatParameters
    for_sensor: ClassVar[bool] = True
    serves: ClassVar[tuple[str, ...]] = ("navsat", "gps")

    def configure(self) -> None:
        sensor, config = self.sensor, self.config
        assert sensor is not None
        device = read_gps(
            self.part,
            sensor,
            "navsat" if sensor.element.find("navsat") else "gps",
            topic=config.topic or default_topic(self.part, sensor, "navsat"),
            velocity_topic=None,
            frame=config.frame or sensor.link,
        )
        self.add(Gps(self.scope, device))
