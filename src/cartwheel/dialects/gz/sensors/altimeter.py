"""Altimeters in gz-sim, which need no plugin."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.position import altimeter
from cartwheel.dialects.gz.sensor_tags import GzSensor, frame_tag, topic_tag


@dataclass(frozen=True, kw_only=True, slots=True)
class AltimeterParameters:
    topic: str = topic_tag("Altimeter", "altimeter")
    frame: str = frame_tag()


class Altimeter(GzSensor[AltimeterParameters]):
    """Publishes a sensor's height above its initial position, and its vertical velocity.

    Heights are in m and velocities in m/s. The message field ``vertical_reference`` is the sensor's
    initial z coordinate in the world. The sensor adds the noise in ``<vertical_position>``
    and ``<vertical_velocity>``.

    The sensor corresponds to ``AltimeterSensor`` in gz-sensors. The message type is the same as in
    ros_gz_bridge.
    """

    serves: ClassVar[tuple[str, ...]] = ("altimeter",)

    def configure(self) -> None:
        sensor = self.sensor
        device = altimeter.AltimeterConfig(
            link=sensor.link,
            mount=sensor.pose.position,
            topic=self.topic("altimeter"),
            frame=self.frame_id,
            rate=sensor.update_rate,
            error=self.noise(
                "altimeter", "altimeter/vertical_position", "altimeter/vertical_velocity"
            ),
        )
        self.add(altimeter.Altimeter(self.scope, device))
