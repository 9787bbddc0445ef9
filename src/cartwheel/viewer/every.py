"""Limits the rate of an action."""

from __future__ import annotations


class Every:
    """Returns whether an action with a maximum `rate` in Hz of wall time is due."""

    def __init__(self, rate: float) -> None:
        self._period = 1.0 / rate
        self._due = 0.0

    def __call__(self, now: float) -> bool:
        if now < self._due:
            return False
        self._due = now + self._period
        return True
