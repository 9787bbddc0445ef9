"""Determines when a periodic task is due, for components that are called more often than that."""

from __future__ import annotations

from fractions import Fraction

from cartwheel.simulation.clock import NANOSECONDS, Ticks


class Periodic:
    """A task that is due at the multiples of its period since time 0.

    Args:
        rate: Hz; 0: always due.
    """

    def __init__(self, rate: float) -> None:
        period = (
            Fraction(NANOSECONDS) / Fraction(rate).limit_denominator(1_000_000) if rate > 0 else 1
        )
        self._multiples = Ticks(max(Fraction(period), Fraction(1)))
        self.next_ns = 0
        """The next due time: until then, `due` need not be called."""

    def start(self, time_ns: int) -> None:
        """Sets the next due time to the first multiple from now on."""
        self.next_ns = self._multiples.due(time_ns)

    def due(self, time_ns: int) -> bool:
        """Whether the task is due. If it is, the next multiple becomes the next due time."""
        if self.next_ns > time_ns:
            return False
        self.next_ns = self._multiples.due(time_ns + 1)
        return True


class Elapsed:
    """Measures the simulation time between the calls of a task."""

    def __init__(self) -> None:
        self._before_ns: int | None = None

    def seconds(self, time_ns: int) -> float:
        """Returns the time since the previous call in s; 0 at the first call."""
        before, self._before_ns = self._before_ns, time_ns
        return 0.0 if before is None else (time_ns - before) * 1e-9
