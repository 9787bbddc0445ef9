"""The intensity of reflected infrared light."""

from __future__ import annotations

import math
from dataclasses import dataclass

from cartwheel.component import Scope
from cartwheel.devices.bases.hazards import nearest
from cartwheel.devices.rays.scan import Scanner, ScannerConfig
from cartwheel.devices.topic_sensor import TopicSensor
from cartwheel.messages import message_class

_MESSAGE = "irobot_create_msgs/msg/IrIntensity"
_BRIGHTEST = 3500.0
"""Intensity at distance 0."""


@dataclass(frozen=True, kw_only=True, slots=True)
class IrIntensityConfig:
    scanner: ScannerConfig
    """Rays of the sensor, whose maximum range is finite."""
    topic: str
    frame: str
    rate: float
    """Publish rate, Hz; 0: every step."""


class IrIntensity(TopicSensor):
    """Publishes the intensity of the light that the nearest obstacle reflects."""

    def __init__(self, scope: Scope, config: IrIntensityConfig) -> None:
        super().__init__(scope, config.frame, config.rate)
        self._scanner = Scanner(self.part, config.scanner)
        self._IrIntensity = message_class(_MESSAGE)
        self._publisher = self._offer(config.topic, _MESSAGE)

    def _measure(self) -> None:
        value = intensity(nearest(self._scanner), self._scanner.pattern.maximum)
        self._publisher.publish(self._IrIntensity(self._header(), int(value)))


def intensity(distance: float, maximum: float) -> float:
    """Returns the intensity of light that is reflected at a distance in m, for a range in m."""
    return _BRIGHTEST * math.exp(-2 * math.e * distance / maximum)
