"""Limits for numbers from outside the simulation, checked in one place for all callers."""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction
from numbers import Integral, Real

import numpy as np

from cartwheel.codes import world as world_codes
from cartwheel.errors import CartwheelError, SimulationError
from cartwheel.geometry import Pose, Quat, quat_normalize
from cartwheel.simulation.clock import NANOSECONDS, to_ns

FARTHEST = 1e6
"""m, rad, m/s or rad/s; the engine considers a state diverged at 1e10."""
STRONGEST = 1e10
"""N or N m."""
LONGEST = 1e9
"""Maximum duration of a run, s."""
SLOWEST, FASTEST = 1e-6, 1e6
"""Real-time factors."""
LEAST_RATE, MOST_RATE = 1e-6, 1e6
"""Hz."""
MOST_STEPS = 1_000_000_000
"""Maximum number of single steps in one request."""


def number(value: float, name: str, *, most: float = FARTHEST) -> float:
    """Checks that a number is finite and within the limit, and returns it.

    Raises:
        CartwheelError: The value is not a number, is not finite, or exceeds the limit.
    """
    try:
        value = float(value)
    except (TypeError, ValueError):
        raise _out_of_range(name, "a number", value) from None
    if not math.isfinite(value):
        raise _out_of_range(name, "a finite number", value)
    if abs(value) > most:
        raise _out_of_range(name, f"between {-most:g} and {most:g}", value)
    return value


def _out_of_range(name: str, wanted: str, value: object) -> CartwheelError:
    number = float(value) if _is_real(value) else None  # type: ignore[arg-type]
    shown = f"{number:g}" if number is not None else repr(value)[:60]
    return CartwheelError(
        f"{name} must be {wanted} (got {shown})",
        code=world_codes.NUMBER_OUT_OF_RANGE,
        values={"name": name, "value": shown if number is None else number},
    )


def duration_ns(seconds: float, name: str = "the duration in s") -> int:
    """Converts the duration of a run, or a time, to nanoseconds.

    Raises:
        CartwheelError: The value is not a number between 0 and `LONGEST`.
    """
    if not _is_real(seconds) or not -0.5 / NANOSECONDS < seconds <= LONGEST:
        raise _out_of_range(name, f"a number between 0 and {LONGEST:g}", seconds)
    return to_ns(seconds)


def rate_period_ns(rate: float) -> Fraction:
    """Converts a rate in Hz to its period in nanoseconds.

    Raises:
        CartwheelError: The rate is not a number between `LEAST_RATE` and `MOST_RATE`.
    """
    if not _is_real(rate) or not LEAST_RATE <= rate <= MOST_RATE:
        wanted = f"a number between {LEAST_RATE:g} and {MOST_RATE:g}"
        raise _out_of_range("the rate in Hz", wanted, rate)
    return NANOSECONDS / Fraction(rate).limit_denominator(1_000_000)


def _is_real(value: object) -> bool:
    """Whether a value is a number, of Python or of numpy, but not a boolean."""
    return isinstance(value, Real) and not isinstance(value, bool | np.bool_)


def numbers(values: Sequence[float], name: str, *, most: float = FARTHEST) -> None:
    """Checks several related numbers; see `number`."""
    for value in values:
        number(value, name, most=most)


def rotation(parts: Sequence[float], name: str) -> Quat:
    """Converts four numbers to a unit quaternion.

    Raises:
        CartwheelError: A number is not finite, or all are zero.
    """
    for part, axis in zip(parts, "xyzw", strict=True):
        number(part, f"{name}.{axis}")
    try:
        return quat_normalize(parts)
    except ValueError as error:
        raise CartwheelError(
            f"{name}: {error}", code=world_codes.NUMBER_OUT_OF_RANGE, values={"name": name}
        ) from None


def check_pose(pose: Pose, name: str) -> None:
    """Rejects a pose with a number that cannot be simulated.

    Raises:
        CartwheelError: See `number`.
    """
    numbers(pose.position, f"the position of {name}")
    rotation(pose.orientation, f"the orientation of {name}")


def check_speed(speed: float | None) -> None:
    """Rejects an invalid real-time factor; None means as fast as possible.

    Raises:
        CartwheelError: The factor is outside `SLOWEST` to `FASTEST`.
    """
    if speed is not None and not (_is_real(speed) and SLOWEST <= speed <= FASTEST):
        shown = f"{speed:g}" if _is_real(speed) else repr(speed)[:60]
        raise CartwheelError(
            f"the real-time factor must be between {SLOWEST:g} and {FASTEST:g} (got {shown})",
            code=world_codes.REAL_TIME_FACTOR_INVALID,
            hint="To stop simulation time, pause the simulation.",
            values={"value": speed if _is_real(speed) else shown},
        )


def check_size(size: int) -> None:
    """Rejects an invalid size of a queue.

    Raises:
        CartwheelError: The size is less than 1.
    """
    if not isinstance(size, int) or isinstance(size, bool) or size < 1:
        raise _out_of_range("the size of a queue", "at least 1", size)


def check_steps(count: int) -> None:
    """Rejects an invalid number of single steps.

    Raises:
        CartwheelError: The number is not between 1 and `MOST_STEPS`.
    """
    if not isinstance(count, int) or isinstance(count, bool) or not 1 <= count <= MOST_STEPS:
        raise CartwheelError(
            f"the number of steps must be between 1 and {MOST_STEPS} (got {count!r:.60})",
            code=world_codes.STEP_COUNT_INVALID,
            values={"value": count if isinstance(count, int) else repr(count)[:60]},
        )


def check_seed(seed: int | None) -> None:
    """Checks the seed for all noise.

    Raises:
        CartwheelError: The seed is not an integer of at least 0, or None.
    """
    if seed is not None and (isinstance(seed, bool) or not isinstance(seed, Integral) or seed < 0):
        raise _out_of_range("the seed", "an integer of at least 0", seed)


def too_many_contacts(contacts: int, error: Exception) -> SimulationError:
    """The error for contacts that do not fit into the memory of the physics engine.

    Args:
        contacts: Number of contacts.
        error: The error of the engine.
    """
    return SimulationError(
        f"the simulation cannot continue with {contacts} contacts: {str(error).splitlines()[0]}",
        code=world_codes.TOO_MANY_CONTACTS,
        hint="Check whether models overlap.",
        values={"contacts": int(contacts)},
    )
