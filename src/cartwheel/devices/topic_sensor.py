"""The base class of sensors that publish messages at a rate."""

from __future__ import annotations

from abc import abstractmethod
from typing import Any

from cartwheel.component import Component, Scope
from cartwheel.graph import Publisher, Qos
from cartwheel.messages import header


class TopicSensor(Component):
    """Measures at its rate while one of its topics has subscribers.

    Args:
        scope: The sensor's model and names.
        frame: Frame ID of the messages, without the robot's prefix.
        rate: Publish rate, Hz; 0: every step.
    """

    def __init__(self, scope: Scope, frame: str, rate: float) -> None:
        super().__init__(scope)
        self._frame = self.frame(frame)
        self._publish_rate = rate
        self.part.schedule(rate, after=self._measure, topics=self.publishers)

    @abstractmethod
    def _measure(self) -> None:
        """Publishes the messages for the current state."""

    def _offer(self, topic: str, kind: str, qos: Qos = "sensor") -> Publisher:
        """Advertises one of the sensor's topics."""
        return self.advertise(topic, kind, rate=self._publish_rate or None, qos=qos)

    def _header(self) -> Any:
        return header(self.part.time_ns, self._frame)
