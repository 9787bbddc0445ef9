"""The rate of a plugin in a sensor."""

from __future__ import annotations


def slowest(*rates: float) -> float:
    """Returns the lowest positive rate, Hz; 0, which stands for every step, if there is none."""
    return min((rate for rate in rates if rate > 0), default=0.0)
