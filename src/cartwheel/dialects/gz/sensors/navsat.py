"""Satellite navigation in gz-sim, which needs no plugin."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.position.gps import Gps
from cartwheel.dialects.gz.sensor_tags import GzSensor, frame_tag, topic_tag
from cartwheel.dialects.sdf.gps import read_gps


@dataclass(frozen=True, kw_only=True, slots=True)
class GzNavSatParameters:
    topic: str = topic_tag("NavSatFix", "navsat")
    frame: str = frame_tag()


class GzNavSat(GzSensor[GzNavSatParameters]):
    """Publishes the latitude, longitude and altitude that a ``navsat`` sensor measures.

    The world's ``<spherical_coordinates>`` define the geographic position of the world's origin.
    The sensor adds the noise in ``<navsat>``, in m. The sensor corresponds to
    ``NavSatSensor`` in gz-sensors.
    """

    serves: ClassVar[tuple[str, ...]] = ("navsat", "gps")

    def configure(self) -> None:
        sensor = self.sensor
        device = read_gps(
            self.part,
            sensor,
            "navsat" if sensor.element.find("navsat") else "gps",
            topic=self.topic("navsat"),
            velocity_topic=None,
            frame=self.frame_id,
        )
        self.add(Gps(self.scope, device))
