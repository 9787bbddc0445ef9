"""Recognises numbers in a wrong unit."""

from __future__ import annotations

import math

_ROUNDED = 3e-4
"""Relative rounding error of degrees with four digits."""
FARTHEST = 100.0
"""Maximum plausible distance between a link and its parent, m."""


def is_converted(angle: float, step: float) -> bool:
    """Whether a number is a multiple of `step` radians converted to degrees: 57.3 is 1 rad."""
    steps = math.radians(angle) / step
    return round(steps) != 0 and abs(steps / round(steps) - 1) < _ROUNDED
