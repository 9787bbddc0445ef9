"""``altimeter`` sensors: height and vertical velocity."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.noise import VectorNoise
from cartwheel.dialects.gz.sensor_tags import default_topic, frame_tag
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.sdf.noise import read_noise
from cartwheel.dialects.tags import tag
from cartwheel.messages import header, message_class

_KIND = "ros_gz_interfaces/msg/Altimeter"


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
    """Publishes the height of a sensor above its initial height, and its vertical velocity.

    Heights are in m and velocities in m/s. The message field ``vertical_reference`` is the initial
    height, measured in the world. The noise in ``<vertical_position>`` and ``<vertical_velocity>``
    is applied. Original sensor: ``AltimeterSensor`` in gz-sensors. The message type is the same as
    in ros_gz_bridge.
    """

    filenames: ClassVar[tuple[str, ...]] = ()
    parameters: ClassVar[type] = AltimeterParameters
    for_sensor: ClassVar[bool] = True
    serves: ClassVar[tuple[str, ...]] = ("altimeter",)

    def configure(self) -> None:
        sensor, part = self.sensor, self.part
        assert sensor is not None
        self._link, self._mount = part.link(sensor.link), sensor.pose.position
        described = part.description.link(sensor.link)
        assert described is not None
        self._reference = (part.start @ described.pose).apply(self._mount)[2]
        self._frame = self.frame(self.config.frame or sensor.link)
        noises = [
            read_noise(sensor.element.find(f"altimeter/{what}/noise"), part.report)
            for what in ("vertical_position", "vertical_velocity")
        ]
        self._noise = VectorNoise(
            part, f"altimeter {sensor.link} {sensor.name}", noises, rate=sensor.update_rate
        )
        self._Altimeter = message_class(_KIND)
        topic = self.config.topic or default_topic(part, sensor, "altimeter")
        rate = sensor.update_rate
        self._publisher = self.advertise(topic, _KIND, rate=rate or None, qos="sensor")
        part.schedule(rate, after=self._measure, active=lambda: self._publisher.wanted)

    def _measure(self) -> None:
        place = self._link.pose.apply(self._mount)
        (_, _, rising), _ = self._link.motion_at(place)
        height, speed = self._noise.add([place[2] - self._reference, rising])
        head = header(self.part.time_ns, self._frame)
        self._publisher.publish(self._Altimeter(head, height, speed, self._reference))
