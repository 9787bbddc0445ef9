"""Limits on the velocity, acceleration and jerk of a drive's commands."""

from __future__ import annotations

import math
from dataclasses import dataclass

from cartwheel.devices.elementwise import Number, clamp, where

Bounds = tuple[float, float]
"""Minimum and maximum."""
UNBOUNDED: Bounds = (-math.inf, math.inf)


@dataclass(frozen=True, kw_only=True, slots=True)
class Limits:
    """Minimum and maximum of each quantity, in m or rad. None: no limit."""

    velocity: Bounds | None = None
    """m/s or rad/s."""
    acceleration: Bounds | None = None
    """m/s² or rad/s²."""
    deceleration: Bounds | None = None
    """Limits while the speed decreases, for forward motion; reversed for backward motion. None:
    `acceleration` limits every change."""
    jerk: Bounds | None = None
    """m/s³ or rad/s³."""

    @property
    def is_instant(self) -> bool:
        """Whether a command takes effect at once, without a ramp."""
        bounds = (self.acceleration, self.deceleration, self.jerk)
        return all(each in {None, UNBOUNDED} for each in bounds)


NO_LIMITS = Limits()


def limited(limits: Limits, wanted: Number, last: Number, before: Number, seconds: float) -> Number:
    """Returns the limited command. Source: diff_drive_controller, speed_limiter.

    Args:
        limits: The limits.
        wanted: The requested command, m/s or rad/s.
        last: The previous command.
        before: The command before the previous one.
        seconds: Time between two commands, s.
    """
    value = wanted
    if limits.jerk is not None:
        change = last - before
        low, high = (bound * 2 * seconds * seconds for bound in limits.jerk)
        value = last + change + clamp(value - last - change, low, high)
    if limits.acceleration is not None:
        low, high = limits.acceleration
        if limits.deceleration is not None:
            slower = (abs(value) < abs(last)) | (value * last < 0)
            braking, reversing = limits.deceleration
            low = where(slower, where(last < 0, -reversing, braking), low)
            high = where(slower, where(last < 0, -braking, reversing), high)
        value = last + clamp(value - last, low * seconds, high * seconds)
    if limits.velocity is not None:
        value = clamp(value, *limits.velocity)
    return value


class Limiter:
    """Limits successive commands, such as the forward velocity or the yaw rate of a drive.

    Args:
        limits: The limits.
    """

    def __init__(self, limits: Limits) -> None:
        self._limits = limits
        self._is_free = limits == NO_LIMITS
        self.reset()

    def reset(self) -> None:
        """Restores the state at rest."""
        self.value: Number = 0.0
        """The last limited command, m/s or rad/s."""
        self._before: Number = 0.0
        self._inputs: tuple[Number, Number, Number, float] | None = None
        self.is_steady = self._is_free
        """Whether the next step with the same arguments changes nothing."""

    def step(self, wanted: Number, seconds: float) -> Number:
        """Returns the limited command; see `limited`."""
        if self._is_free:
            self.value = wanted
            return wanted
        inputs = (wanted, self.value, self._before, seconds)
        if inputs == self._inputs:
            # A constant command: the result of the last step.
            self.is_steady = True
            return self.value
        self._inputs, self.is_steady = inputs, False
        value = limited(self._limits, wanted, self.value, self._before, seconds)
        self._before, self.value = self.value, value
        return value
