"""PID controllers of quadrotors, whose targets are limited and filtered."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True, slots=True)
class FilteredPidConfig:
    """Gains and filter of a `FilteredPid`."""

    p: float
    """Gain of the error."""
    i: float
    """Gain of the integral of the error, 1/s."""
    d: float
    """Gain of the rate of change of the error, s."""
    time_constant: float
    """Time constant of the low-pass filter of the target, s; 0: no filter."""
    limit: float
    """Largest magnitude of the target; 0 or less: no limit."""


class FilteredPid:
    """Controls a quantity whose rate of change is also measured.

    Args:
        config: Gains and filter.
        leads: Whether the rate of the target includes its last change if there is no filter.
    """

    def __init__(self, config: FilteredPidConfig, *, leads: bool = False) -> None:
        self.config = config
        self._leads = leads
        self.reset()

    def reset(self) -> None:
        """Clears the filter and the integral."""
        self._target = 0.0
        self.integral = 0.0
        """Integral of the error."""

    def update(self, target: float, value: float, rate: float, seconds: float) -> float:
        """Returns the output.

        Args:
            target: Target value.
            value: Measured value.
            rate: Measured rate of change.
            seconds: Time since the last update, positive.
        """
        config = self.config
        if config.limit > 0:
            target = min(max(target, -config.limit), config.limit)
        span = seconds + config.time_constant
        change = target - self._target
        self._target += seconds / span * change
        target_rate = (change if self._leads else target - self._target) / span
        error = self._target - value
        self.integral += seconds * error
        return config.p * error + config.i * self.integral + config.d * (target_rate - rate)

    def acceleration(self, target: float, velocity: float, seconds: float) -> float:
        """Returns the output of a velocity controller that causes the acceleration of its output.

        The rate of change of the velocity is then the output itself. With the rate of the previous
        step, the output would oscillate for derivative gains of 1 or more.
        """
        output = self.update(target, velocity, 0.0, seconds)
        return output / (1.0 + max(self.config.d, 0.0))
