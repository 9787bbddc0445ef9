"""Arithmetic that accepts floats and arrays, with equal results for both.

Devices use these functions, so that one formula computes one robot with floats or many robots with
arrays. Floats stay floats. Arrays are computed element by element, and each element has the same
bits as the result for the float: NumPy's own functions differ from those of `math` in the last bit.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

Number = Any
"""A float, or an array of floats."""


def where(condition: Any, value: Number, other: Number) -> Number:
    """Returns `value` where the condition is true, and `other` elsewhere."""
    if isinstance(condition, np.ndarray):
        return np.where(condition, value, other)
    return value if condition else other


def minimum(value: Number, other: Number) -> Number:
    """Returns the smaller number, and `value` if both are equal, as `min` does."""
    return where(other < value, other, value)


def maximum(value: Number, other: Number) -> Number:
    """Returns the larger number, and `value` if both are equal, as `max` does."""
    return where(other > value, other, value)


def clamp(value: Number, low: Number, high: Number) -> Number:
    """Returns the number between `low` and `high` that is nearest to `value`."""
    return minimum(maximum(value, low), high)


def sin(angle: Number) -> Number:
    """Returns the sine of an angle in rad."""
    return _SIN(angle) if isinstance(angle, np.ndarray) else math.sin(angle)


def cos(angle: Number) -> Number:
    """Returns the cosine of an angle in rad."""
    return _COS(angle) if isinstance(angle, np.ndarray) else math.cos(angle)


def tan(angle: Number) -> Number:
    """Returns the tangent of an angle in rad."""
    return _TAN(angle) if isinstance(angle, np.ndarray) else math.tan(angle)


def atan(value: Number) -> Number:
    """Returns the angle in rad between -π/2 and π/2 with this tangent."""
    return _ATAN(value) if isinstance(value, np.ndarray) else math.atan(value)


def atan2(y: Number, x: Number) -> Number:
    """Returns the direction of the point (x, y) in rad."""
    if isinstance(y, np.ndarray) or isinstance(x, np.ndarray):
        return _ATAN2(y, x)
    return math.atan2(y, x)


def copysign(value: Number, sign: Number) -> Number:
    """Returns the magnitude of `value` with the sign of `sign`."""
    if isinstance(value, np.ndarray) or isinstance(sign, np.ndarray):
        return np.copysign(value, sign)
    return math.copysign(value, sign)


def power(value: Number, exponent: float) -> Number:
    """Returns a number that is not negative, raised to a positive exponent."""
    return _POW(value, exponent) if isinstance(value, np.ndarray) else math.pow(value, exponent)


# NumPy's own sine and its relatives round differently from those in `math`.
_SIN, _COS, _TAN, _ATAN, _ATAN2, _POW = (
    np.vectorize(function, otypes=[float])
    for function in (math.sin, math.cos, math.tan, math.atan, math.atan2, math.pow)
)
