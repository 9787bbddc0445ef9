"""The base class of sensors on a link that add errors to what they measure."""

from __future__ import annotations

from typing import Protocol

from cartwheel.component import Scope
from cartwheel.devices.noise import ErrorConfig, sensor_error
from cartwheel.devices.topic_sensor import TopicSensor


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


class LinkSensor(TopicSensor):
    """A sensor on a link, with errors.

    Args:
        scope: The sensor's model and names.
        config: Link, frame, rate and errors.

    Raises:
        UnknownNameError: The link does not exist.
    """

    def __init__(self, scope: Scope, config: LinkSensorConfig) -> None:
        super().__init__(scope, config.frame, config.rate)
        self._link = self.part.link(config.link, origin=self.origin)
        self._error = sensor_error(self.part, config.error)

    def reset(self) -> None:
        """Starts a new drift."""
        super().reset()
        self._error.restart()
