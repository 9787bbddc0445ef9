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
_Array = np.ndarray


def where(condition: Any, value: Number, other: Number) -> Number:
    """Returns `value` where the condition is true, and `other` elsewhere."""
    if condition.__class__ is bool or not isinstance(condition, _Array):
        return value if condition else other
    return np.where(condition, value, other)


def anywhere(condition: Any) -> bool:
    """Whether a condition is true, for an array in any element."""
    if condition.__class__ is bool:
        return condition
    return bool(condition.any()) if isinstance(condition, _Array) else bool(condition)


def minimum(value: Number, other: Number) -> Number:
    """Returns the smaller number, and `value` if both are equal, as `min` does."""
    if value.__class__ is float and other.__class__ is float:
        return other if other < value else value
    if isinstance(value, _Array) or isinstance(other, _Array):
        return np.where(other < value, other, value)
    return min(value, other)


def maximum(value: Number, other: Number) -> Number:
    """Returns the larger number, and `value` if both are equal, as `max` does."""
    if value.__class__ is float and other.__class__ is float:
        return other if other > value else value
    if isinstance(value, _Array) or isinstance(other, _Array):
        return np.where(other > value, other, value)
    return max(value, other)


def clamp(value: Number, low: Number, high: Number) -> Number:
    """Returns the number between `low` and `high` that is nearest to `value`."""
    if value.__class__ is float and low.__class__ is float and high.__class__ is float:
        # Comparisons take a quarter of the time of `min` and `max`.
        if low > value:  # noqa: PLR1730
            value = low
        return high if high < value else value
    if isinstance(value, _Array) or isinstance(low, _Array) or isinstance(high, _Array):
        return minimum(maximum(value, low), high)
    return min(max(value, low), high)


def sin(angle: Number) -> Number:
    """Returns the sine of an angle in rad."""
    return _SIN(angle) if isinstance(angle, _Array) else math.sin(angle)


def cos(angle: Number) -> Number:
    """Returns the cosine of an angle in rad."""
    return _COS(angle) if isinstance(angle, _Array) else math.cos(angle)


def tan(angle: Number) -> Number:
    """Returns the tangent of an angle in rad."""
    return _TAN(angle) if isinstance(angle, _Array) else math.tan(angle)


def atan(value: Number) -> Number:
    """Returns the angle in rad between -π/2 and π/2 with this tangent."""
    return _ATAN(value) if isinstance(value, _Array) else math.atan(value)


def atan2(y: Number, x: Number) -> Number:
    """Returns the direction of the point (x, y) in rad."""
    if isinstance(y, _Array) or isinstance(x, _Array):
        return _ATAN2(y, x)
    return math.atan2(y, x)


def copysign(value: Number, sign: Number) -> Number:
    """Returns the magnitude of `value` with the sign of `sign`."""
    if isinstance(value, _Array) or isinstance(sign, _Array):
        return np.copysign(value, sign)
    return math.copysign(value, sign)


def sqrt(value: Number) -> Number:
    """Returns the square root of a number that is not negative."""
    return np.sqrt(value) if isinstance(value, np.ndarray) else math.sqrt(value)


def power(value: Number, exponent: float) -> Number:
    """Returns a number that is not negative, raised to a positive exponent."""
    return _POW(value, exponent) if isinstance(value, _Array) else math.pow(value, exponent)


def remainder(value: Number, divisor: float) -> Number:
    """Returns the remainder that is nearest to 0, as `math.remainder` does."""
    if isinstance(value, _Array):
        return _REMAINDER(value, divisor)
    return math.remainder(value, divisor)


# NumPy's own sine and its relatives round differently from those in `math`.
_SIN, _COS, _TAN, _ATAN, _ATAN2, _POW, _REMAINDER = (
    np.vectorize(function, otypes=[float])
    for function in (math.sin, math.cos, math.tan, math.atan, math.atan2, math.pow, math.remainder)
)
