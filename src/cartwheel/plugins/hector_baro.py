"""``libhector_gazebo_ros_baro.so``: a height by the pressure of the air."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.messages import header, message_class
from cartwheel.plugins.base import Plugin
from cartwheel.plugins.noise import DriftingError
from cartwheel.plugins.parameters import tag

_SCALE_HEIGHT = 44330.0
"""m: where the formula's pressure ends."""
_EXPONENT = 5.263157


@dataclass(frozen=True, kw_only=True, slots=True)
class HectorBaroParameters:
    body: str = tag("bodyName", default="", doc="Link that carries it; the root when empty.")
    topic: str = tag(
        "topicName", default="pressure_height", doc="PointStamped, z is the height; none if empty."
    )
    altimeter_topic: str = tag(
        "altimeterTopicName", default="altimeter", doc="Altimeter; none if empty."
    )
    frame: str = tag("frameId", default="", doc="Frame of the messages; the link's when empty.")
    update_rate: float = tag("updateRate", default=0.0, unit="Hz", doc="0 is every step.")
    elevation: float = tag(
        "elevation", default=0.0, unit="m", doc="Of the world's origin above the sea."
    )
    qnh: float = tag("qnh", default=1013.25, unit="hPa", doc="Pressure at the sea.")
    offset: float = tag("offset", default=0.0, unit="m", doc="Constant error.")
    drift: float = tag("drift", default=0.0, unit="m", doc="Standard deviation of the drift.")
    frequency: float = tag("driftFrequency", default=1 / 3600.0, unit="1/s", doc="Of the drift.")
    noise: float = tag("gaussianNoise", default=0.0, unit="m", doc="Standard deviation.")
    scale: float = tag("scaleError", default=1.0, doc="Factor.")


class HectorBaro(Plugin[HectorBaroParameters]):
    """Publishes a link's height in the world, and its altitude with the pressure there.

    ``pressure = qnh (1 - altitude / 44330 m) ^ 5.263157``, of the altitude that was measured.
    Errors are those of `HectorImu`. Source: hector_quadrotor_gazebo_plugins, gazebo_ros_baro.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libhector_gazebo_ros_baro.so",)
    parameters: ClassVar[type] = HectorBaroParameters

    def configure(self) -> None:
        config, part, origin = self.config, self.part, self.tag.origin
        self.check_not_negative("update_rate", "drift", "frequency", "noise")
        name = config.body or part.description.canonical_link
        self._link = part.link(name, origin=origin)
        self._frame = self.frame(config.frame or name)
        self._error = DriftingError(
            part,
            f"baro {config.topic} {config.altimeter_topic}",
            rate=config.update_rate,
            offset=[config.offset],
            drift=[config.drift],
            frequency=[config.frequency],
            noise=[config.noise],
            scale=[config.scale],
        )
        self._PointStamped = message_class("geometry_msgs/msg/PointStamped")
        self._Point = message_class("geometry_msgs/msg/Point")
        self._Altimeter = message_class("hector_uav_msgs/msg/Altimeter")
        rate = config.update_rate or None
        self._heights, self._altitudes = (
            self.advertise(topic, kind, rate=rate, qos="sensor") if topic else None
            for topic, kind in (
                (config.topic, "geometry_msgs/msg/PointStamped"),
                (config.altimeter_topic, "hector_uav_msgs/msg/Altimeter"),
            )
        )
        part.schedule(config.update_rate, after=self._measure, active=self._wanted)

    def reset(self) -> None:
        self._error.restart()

    def _wanted(self) -> bool:
        return any(each is not None and each.wanted for each in (self._heights, self._altitudes))

    def _measure(self) -> None:
        config = self.config
        (_, _, z), _ = self._link.place()
        height = float(self._error.add([z])[0])
        head = header(self.part.time_ns, self._frame)
        if self._heights is not None and self._heights.wanted:
            self._heights.publish(self._PointStamped(head, self._Point(0.0, 0.0, height)))
        if self._altitudes is not None and self._altitudes.wanted:
            altitude = height + config.elevation
            share = max(1.0 - altitude / _SCALE_HEIGHT, 0.0)
            pressure = config.qnh * share**_EXPONENT
            self._altitudes.publish(self._Altimeter(head, altitude, pressure, config.qnh))
