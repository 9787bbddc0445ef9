"""Simulation time in integer nanoseconds, and what is due when."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

NANOSECONDS = 1_000_000_000


def to_ns(seconds: float) -> int:
    """Seconds as integer nanoseconds, rounded to the nearest."""
    return round(seconds * NANOSECONDS)


class Task:
    """Something done at a rate, at fixed multiples of its period since time zero.

    A due time that falls between two steps is met at the next step, without drift: the
    mean rate is the stated one, and all tasks of one rate fall on the same steps whenever
    their model was spawned.

    Args:
        rate: Hz; 0 is every step.
        before: Writes controls, before the step that starts at the due time; or None.
        after: Reads the state of the due time and publishes; or None.
        active: Whether there is anything to do; a task that says no costs nothing.
        step_ns: Length of a step.
        order: Tasks of one time run in this order.
    """

    __slots__ = ("active", "after", "before", "due", "order", "period", "rate")

    def __init__(
        self,
        *,
        rate: float,
        before: Callable[[], None] | None,
        after: Callable[[], None] | None,
        active: Callable[[], bool],
        step_ns: int,
        order: int,
    ) -> None:
        self.rate = rate
        self.before = before
        self.after = after
        self.active = active
        self.order = order
        period = Fraction(step_ns)
        if rate > 0:
            period = max(period, NANOSECONDS / Fraction(rate).limit_denominator(1_000_000))
        self.period = period / step_ns
        """In steps; a rate faster than the step runs every step."""
        self.due = 0
        """The step at which it runs next."""

    def reset(self, step: int) -> None:
        """Makes the next due step the first one at or after `step`."""
        count = -((-step * self.period.denominator) // self.period.numerator)
        self.due = _ceil(count * self.period)

    def advance(self, step: int) -> None:
        """Moves the due step beyond `step`."""
        count = (step * self.period.denominator) // self.period.numerator + 1
        self.due = _ceil(count * self.period)


def _ceil(value: Fraction) -> int:
    return -((-value.numerator) // value.denominator)
