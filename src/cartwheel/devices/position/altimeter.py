"""Altimeters: height and vertical velocity."""

from __future__ import annotations

from dataclasses import dataclass

from cartwheel.component import Scope
from cartwheel.devices.noise import ErrorConfig
from cartwheel.devices.position.link_sensor import LinkSensor
from cartwheel.geometry import Vec3
from cartwheel.messages import message_class

_ALTIMETER = "ros_gz_interfaces/msg/Altimeter"


@dataclass(frozen=True, kw_only=True, slots=True)
class AltimeterConfig:
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


class Altimeter(LinkSensor):
    """Publishes the height of an altimeter above its initial height, and its vertical velocity.

    Args:
        scope: The altimeter's model and names.
        config: Link, topic and errors.

    Raises:
        UnknownNameError: The link does not exist.
    """

    def __init__(self, scope: Scope, config: AltimeterConfig) -> None:
        super().__init__(scope, config)
        part, self._mount = self.part, config.mount
        described = part.description.link(config.link)
        assert described is not None
        self._reference = (part.start @ described.pose).apply(config.mount)[2]
        self._Altimeter = message_class(_ALTIMETER)
        self._publisher = self._offer(config.topic, _ALTIMETER)

    def _measure(self) -> None:
        place = self._link.pose.apply(self._mount)
        (_, _, rising), _ = self._link.motion_at(place)
        height, speed = self._error.add([place[2] - self._reference, rising])
        self._publisher.publish(self._Altimeter(self._header(), height, speed, self._reference))
