"""``libhector_gazebo_ros_baro.so``: a barometric altimeter."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.noise import DriftingError
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag
from cartwheel.messages import header, message_class

_SCALE_HEIGHT = 44330.0
"""m; the formula gives a pressure of 0 at this altitude."""
_EXPONENT = 5.263157


@dataclass(frozen=True, kw_only=True, slots=True)
class HectorBaroParameters:
    body: str = tag("bodyName", default="", doc="Link of the barometer. Default: the root link.")
    topic: str = tag(
        "topicName",
        default="pressure_height",
        doc="Topic of the z position (PointStamped). Not published if empty.",
    )
    altimeter_topic: str = tag(
        "altimeterTopicName",
        default="altimeter",
        doc="Topic of the Altimeter messages. Not published if empty.",
    )
    frame: str = tag("frameId", default="", doc="Frame ID of the messages. Default: the link.")
    update_rate: float = tag(
        "updateRate", default=0.0, unit="Hz", doc="Publish rate. 0: every step."
    )
    elevation: float = tag(
        "elevation", default=0.0, unit="m", doc="Altitude of the world's origin above sea level."
    )
    qnh: float = tag("qnh", default=1013.25, unit="hPa", doc="Pressure at sea level.")
    offset: float = tag("offset", default=0.0, unit="m", doc="Constant error of the z position.")
    drift: float = tag("drift", default=0.0, unit="m", doc="Standard deviation of the drift.")
    frequency: float = tag(
        "driftFrequency",
        default=1 / 3600.0,
        unit="1/s",
        doc="Inverse of the drift's time constant.",
    )
    noise: float = tag(
        "gaussianNoise", default=0.0, unit="m", doc="Standard deviation of the noise."
    )
    scale: float = tag("scaleError", default=1.0, doc="Scale factor on the z position.")


class HectorBaro(Plugin[HectorBaroParameters]):
    """Publishes a link's z position in the world, its altitude above sea level and the pressure.

    The z position has an offset, a drift, noise and a scale factor, as in
    ``libhector_gazebo_ros_imu.so``. The air pressure is computed from the measured altitude:
    ``pressure = qnh (1 - altitude / 44330 m) ^ 5.263157``. Original plugin: ``gazebo_ros_baro`` in
    the package ``hector_quadrotor_gazebo_plugins``.
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
