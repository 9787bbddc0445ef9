"""The base class of sensors on a link that add errors to what they measure."""

from __future__ import annotations

from abc import abstractmethod
from typing import Any, Protocol

from cartwheel.component import Component, Scope
from cartwheel.devices.noise import ErrorConfig, sensor_error
from cartwheel.graph import Publisher, Qos
from cartwheel.messages import header


class LinkSensorConfig(Protocol):
    """The fields that the configurations of these sensors share."""

    @property
    def link(self) -> str:
        """Link that carries the sensor."""

    @property
    def frame(self) -> str:
        """Frame ID of the messages, without the robot's prefix."""

    @property
    def rate(self) -> float:
        """Publish rate, Hz; 0: every step."""

    @property
    def error(self) -> ErrorConfig:
        """Errors of the measured values."""


class LinkSensor(Component):
    """A sensor on a link. It measures at its rate while one of its topics has subscribers.

    Args:
        scope: The sensor's model and names.
        config: Link, frame, rate and errors.

    Raises:
        UnknownNameError: The link does not exist.
    """

    def __init__(self, scope: Scope, config: LinkSensorConfig) -> None:
        super().__init__(scope)
        self._link = self.part.link(config.link, origin=self.origin)
        self._frame = self.frame(config.frame)
        self._error = sensor_error(self.part, config.error)
        self._rate = config.rate
        self.part.schedule(config.rate, after=self._measure, topics=self.publishers)

    def reset(self) -> None:
        """Starts a new drift."""
        super().reset()
        self._error.restart()

    @abstractmethod
    def _measure(self) -> None:
        """Publishes the messages for the current state."""

    def _offer(self, topic: str, kind: str, qos: Qos = "sensor") -> Publisher:
        """Advertises one of the sensor's topics."""
        return self.advertise(topic, kind, rate=self._rate or None, qos=qos)

    def _header(self) -> Any:
        return header(self.part.time_ns, self._frame)
