"""Altimeters: height and vertical velocity."""

from __future__ import annotations

from dataclasses import dataclass

from cartwheel.component import Component, Scope
from cartwheel.devices.noise import ErrorConfig, sensor_error
from cartwheel.geometry import Vec3
from cartwheel.messages import header, message_class

_ALTIMETER = "ros_gz_interfaces/msg/Altimeter"


@dataclass(frozen=True, kw_only=True, slots=True)
class AltimeterConfig:
    """Configuration of an `Altimeter`."""

    link: str
    """Link that carries the altimeter."""
    mount: Vec3
    """Position of the altimeter in the link, m."""
    topic: str
    """Topic of the Altimeter messages."""
    frame: str
    """Frame ID of the messages, without the robot's prefix."""
    rate: float
    """Publish rate, Hz; 0: every step."""
    error: ErrorConfig
    """Errors of the height, m, and of the vertical velocity, m/s."""


class Altimeter(Component):
    """Publishes the height of an altimeter above its initial height, and its vertical velocity.

    Args:
        scope: The altimeter's model and names.
        config: Link, topic and errors.

    Raises:
        UnknownNameError: The link does not exist.
    """

    def __init__(self, scope: Scope, config: AltimeterConfig) -> None:
        super().__init__(scope)
        part = self.part
        self._link, self._mount = part.link(config.link, origin=self.origin), config.mount
        described = part.description.link(config.link)
        assert described is not None
        self._reference = (part.start @ described.pose).apply(config.mount)[2]
        self._frame = self.frame(config.frame)
        self._error = sensor_error(part, config.error)
        self._Altimeter = message_class(_ALTIMETER)
        self._publisher = self.advertise(
            config.topic, _ALTIMETER, rate=config.rate or None, qos="sensor"
        )
        part.schedule(config.rate, after=self._measure, active=lambda: self._publisher.wanted)

    def reset(self) -> None:
        """Starts new drifts."""
        super().reset()
        self._error.restart()

    def _measure(self) -> None:
        place = self._link.pose.apply(self._mount)
        (_, _, rising), _ = self._link.motion_at(place)
        height, speed = self._error.add([place[2] - self._reference, rising])
        moment = header(self.part.time_ns, self._frame)
        self._publisher.publish(self._Altimeter(moment, height, speed, self._reference))
