"""Vectors from the callers of the Python API."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import SupportsFloat, TypeVar

import numpy as np
from numpy.typing import NDArray

from cartwheel.codes.world import VALUE_INVALID
from cartwheel.errors import CartwheelError
from cartwheel.geometry import Array, Vec3
from cartwheel.messages.times import Stamp, is_stamp, nanoseconds
from cartwheel.simulation.limits import LONGEST, duration_ns

Vector = Sequence[float] | NDArray[np.float64]
"""Three numbers."""
Moment = float | Stamp
"""A time in s, or the stamp of a message."""
T = TypeVar("T")


def vector(values: Vector, name: str) -> Vec3:
    """Three finite numbers.

    Raises:
        CartwheelError: There are not three numbers, or one is not finite.
    """
    x, y, z = array(values, (3,), name).tolist()
    return x, y, z


def array(values: object, shape: tuple[int, ...], name: str) -> Array:
    """An array of finite numbers.

    Raises:
        CartwheelError: The shape is different, or a value is not a finite number.
    """
    try:
        # numpy would convert texts that contain numbers.
        texts = np.array(values).dtype.kind in "US"
        made = np.empty(0) if texts else np.array(values, dtype=np.float64)
    except (TypeError, ValueError):
        made = np.empty(0)
    if made.shape != shape or not np.isfinite(made).all():
        size = " x ".join(map(str, shape))
        wanted = f"must be {size} finite numbers" if shape else "must be a finite number"
        raise invalid(name, wanted, values)
    return made


def instance(value: object, kind: type[T], name: str, example: str) -> T:
    """A value of a class.

    Raises:
        CartwheelError: It is of another class.
    """
    if not isinstance(value, kind):
        error = invalid(name, f"must be a {kind.__name__}", value)
        error.hint = f"Write {example}."
        raise error
    return value


def scalar(
    value: SupportsFloat,
    name: str,
    *,
    least: float = -math.inf,
    above: float = -math.inf,
    most: float = math.inf,
) -> float:
    """A finite number.

    Args:
        value: The number.
        name: Its name, for the error.
        least: The smallest number that is allowed.
        above: The number must be larger than this.
        most: The largest number that is allowed.

    Raises:
        CartwheelError: The value is not a finite number, or is too small or too large.
    """
    try:
        # A text is most likely a mistake, although Python converts some.
        number = None if isinstance(value, str | bytes) else float(value)
    except (TypeError, ValueError):
        number = None
    if number is None:
        raise invalid(name, "must be a number", value)
    if not math.isfinite(number):
        raise invalid(name, "must be finite", value)
    if number <= above:
        raise invalid(name, f"must be above {above:g}", value)
    if number < least:
        raise invalid(name, f"must be at least {least:g}", value)
    if number > most:
        raise invalid(name, f"must be at most {most:g}", value)
    return number


def duration(value: SupportsFloat, name: str) -> float:
    """The duration of a run, s.

    Raises:
        CartwheelError: It is not a number from 0 to `LONGEST`.
    """
    return scalar(value, name, least=0.0, most=LONGEST)


def flag(value: object, name: str) -> bool:
    """Whether something is so: True or False, or 1 or 0.

    Raises:
        CartwheelError: It is anything else, such as a text.
    """
    if not isinstance(value, bool | int | np.bool_ | np.integer) or value not in (0, 1):
        raise invalid(name, "must be True or False", value)
    return bool(value)


def moment_ns(time: Moment, name: str = "the time in s") -> int:
    """A time in s, or the stamp of a message, in ns.

    Raises:
        CartwheelError: The time is not a number, negative or too large.
    """
    return nanoseconds(time) if is_stamp(time) else duration_ns(time, name)  # type: ignore[arg-type]


def invalid(name: str, rule: str, value: object) -> CartwheelError:
    """The error for a value that a property cannot have."""
    shown = repr(value)
    shown = shown if len(shown) <= 80 else f"{shown[:80]}…"
    return CartwheelError(
        f"{name} {rule} (got {shown})", code=VALUE_INVALID, values={"name": name, "value": shown}
    )
