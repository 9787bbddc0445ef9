"""Range finders: the distance to the nearest object in a cone."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cartwheel.component import Scope
from cartwheel.devices.noise import DriftingError, DriftingErrorConfig
from cartwheel.devices.rays.messages import range_message
from cartwheel.devices.rays.scan import Scanner, ScannerConfig
from cartwheel.devices.topic_sensor import TopicSensor


@dataclass(frozen=True, kw_only=True, slots=True)
class RangeFinderConfig:
    scanner: ScannerConfig
    """The rays."""
    topic: str
    """Topic of the Range messages."""
    frame: str
    """Frame ID of the messages, without the robot's prefix."""
    rate: float
    """Publish rate, Hz; 0: every step."""
    fov: float
    """Field of view in the messages, rad."""
    infrared: bool
    """Set the radiation type to infrared instead of ultrasound."""
    noise: float | None = None
    """Standard deviation of the noise, m; None: the noise of the scanner's pattern."""
    offset: float = 0.0
    """Constant error, m."""
    drift: float = 0.0
    """Standard deviation of a slow drift, m."""
    drift_frequency: float = 0.0
    """Inverse of the drift's time constant, 1/s."""


class RangeFinder(TopicSensor):
    """Publishes the smallest range of a scan, or the maximum range if nothing is hit.

    The noise is that of one range: the minimum over rays with noise of their own would be too
    small.

    Args:
        scope: The range finder's model and names.
        config: Rays, topic and errors.
    """

    def __init__(self, scope: Scope, config: RangeFinderConfig) -> None:
        super().__init__(scope, config.frame, config.rate)
        self._config = config
        self._scanner = Scanner(self.part, config.scanner)
        self._error = DriftingError(
            self.part,
            DriftingErrorConfig(
                name=f"range {config.scanner.name}",
                rate=config.rate,
                offset=[config.offset],
                drift=[config.drift],
                frequency=[config.drift_frequency],
                noise=[config.noise or 0.0],
                scale=[1.0],
            ),
        )
        self._publisher = self._offer(config.topic, "sensor_msgs/msg/Range")

    def reset(self) -> None:
        """Starts a new drift."""
        super().reset()
        self._error.restart()

    def _measure(self) -> None:
        config, pattern = self._config, self._scanner.pattern
        ranges = self._scanner.measure(noisy=False).ranges
        value = float(np.clip(ranges.min(), pattern.minimum, pattern.maximum))
        if value < pattern.maximum:
            if config.noise is None:
                (value,) = self._scanner.error.add([value])
            (value,) = self._error.add([value])
            value = min(max(value, pattern.minimum), pattern.maximum)
        fov, infrared = config.fov, config.infrared
        self._publisher.publish(
            range_message(self._header(), pattern, value, fov=fov, infrared=infrared)
        )
