"""Simulation time in integer nanoseconds, and the schedule of tasks."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable
from fractions import Fraction
from typing import Protocol

NANOSECONDS = 1_000_000_000
NEVER = 1 << 40
"""Steps."""
_FINEST = 1_000_000
"""Maximum denominator of rates."""
SLOWEST = 1 / _FINEST
"""Hz; tasks with lower rates run at this rate."""
_KEPT = 1 << 15
"""Maximum number of cached steps in a cycle."""


def to_ns(seconds: float) -> int:
    """Seconds as integer nanoseconds, rounded to the nearest."""
    return round(seconds * NANOSECONDS)


def always() -> bool:
    """The default for `Task.active`: the task runs whenever it is due."""
    return True


class Topic(Protocol):
    """A topic on which a task publishes."""

    wanted: bool
    """Whether it has subscribers."""


class Task:
    """A task that runs at a rate, at fixed multiples of its period since time zero.

    A due time between two steps is handled at the next step, without drift. The mean rate is exact,
    and all tasks with the same rate run in the same steps, whenever their model was spawned.

    Args:
        rate: Hz; 0 runs at every step.
        before: Writes controls, before the step that starts at the due time; or None.
        after: Reads the state at the due time and publishes; or None.
        active: Whether the task has anything to do; called when the task is due.
        topics: While none of them has subscribers, the task is not due. None: always due.
        idle: Returns whether the task would change nothing, also later, unless another task or a
            command changes something before. The simulation then need not stop for it. None: never.
        order: Tasks due at the same time run in this order.
    """

    __slots__ = (
        "_ticks",
        "active",
        "after",
        "asleep",
        "before",
        "idle",
        "order",
        "owner",
        "period_ns",
        "rate",
        "reads_state",
        "topics",
    )

    def __init__(
        self,
        *,
        rate: float,
        before: Callable[[], None] | None,
        after: Callable[[], None] | None,
        active: Callable[[], bool],
        topics: Collection[Topic] | None = None,
        idle: Callable[[], bool] | None = None,
        order: int,
    ) -> None:
        self.rate = rate
        self.before = before
        self.after = after
        self.active = active
        self.topics = topics
        self.idle = idle
        self.asleep = False
        """Whether the task is not due until its owner wakes it."""
        self.reads_state = False
        """Whether `before` reads only positions and velocities of joints, and nothing that the last
        step computed from them. Physics that MuJoCo does not compute then takes less time."""
        self.order = order
        self._ticks: tuple[int, int, Ticks] | None = None
        """For a length of a step and the time of step zero."""
        self.owner: object = None
        """The plugin that owns the task; None for the simulation's own tasks."""
        self.period_ns = Fraction(0)
        if rate > 0:
            # Limit the rate from above, where every step is due, and from below, where the fraction
            # would be rounded to zero.
            fast = Fraction(min(rate, NANOSECONDS)).limit_denominator(_FINEST)
            self.period_ns = NANOSECONDS / max(fast, Fraction(1, _FINEST))

    def forget(self) -> None:
        """Deactivates the task and clears its references."""
        self.before = self.after = None
        self.active = always
        self.topics = self.idle = None

    @property
    def awake(self) -> bool:
        """Whether the task can be due."""
        if self.asleep:
            return False
        return self.topics is None or any(topic.wanted for topic in self.topics)

    def period(self, step_ns: int) -> Fraction:
        """Period in steps; at least 1."""
        return max(self.period_ns / step_ns, Fraction(1))

    def ticks(self, step_ns: int, origin_ns: int) -> Ticks:
        """The steps at which the task is due.

        Args:
            step_ns: Length of a step.
            origin_ns: The time of step zero.
        """
        known = self._ticks
        if known is None or known[:2] != (step_ns, origin_ns):
            made = Ticks(self.period(step_ns), Fraction(origin_ns, step_ns))
            known = self._ticks = step_ns, origin_ns, made
        return known[2]


class Ticks:
    """The steps at which tasks with one period are due: ⌈k period - offset⌉ for k = 0, 1, 2 …

    Args:
        period: Steps, at least 1.
        offset: Steps of this length between time zero and step zero.
    """

    __slots__ = ("_denominator", "_numerator", "_offset", "cycle", "period")

    def __init__(self, period: Fraction, offset: Fraction = Fraction(0)) -> None:
        self.period = period
        self.cycle = period.numerator
        """Number of steps after which the due steps repeat."""
        if period == 1:
            offset = Fraction(0)
        self._denominator = math.lcm(period.denominator, offset.denominator)
        self._numerator = int(period * self._denominator)
        self._offset = int(offset * self._denominator)

    def due(self, step: int) -> int:
        """The first due step at or after `step`."""
        count = ((step - 1) * self._denominator + self._offset) // self._numerator + 1
        return -((self._offset - count * self._numerator) // self._denominator)

    def last(self, step: int) -> int:
        """The last due step before `step`."""
        count = ((step - 1) * self._denominator + self._offset) // self._numerator
        return -((self._offset - count * self._numerator) // self._denominator)


Due = tuple[tuple[Task, ...], tuple[Task, ...], int]
"""Due tasks that write controls or have to be asked whether they are active; due tasks that only
read the state; and the next step with due tasks."""


class Schedule:
    """Tasks by period, with a cached cycle of all periods.

    Each step needs one table lookup, regardless of the number of tasks and periods.

    Args:
        tasks: In any order. Only those that are awake are scheduled.
        step_ns: Length of a step.
        origin_ns: The time of step zero.
    """

    def __init__(self, tasks: Iterable[Task] = (), *, step_ns: int = 1, origin_ns: int = 0) -> None:
        ordered = sorted((task for task in tasks if task.awake), key=lambda task: task.order)
        self._tasks = [(task, task.period(step_ns)) for task in ordered]
        offset = Fraction(origin_ns, step_ns)
        self._ticks = [
            Ticks(period, offset) for period in {period: None for _, period in self._tasks}
        ]
        self._cycle = math.lcm(*(ticks.cycle for ticks in self._ticks))
        self.may_skip = any(task.idle is not None for task in ordered)
        """Whether `skip` may have an effect."""
        self._met: dict[int, Due] = {}
        """Cache by step in the cycle; the step of the next due tasks is relative."""
        self._together: dict[int, tuple[tuple[Task, ...], tuple[Task, ...]]] = {}
        """Cache of tasks that are due together, by a bit mask of their periods."""
        self.every = self._look(0) if self._cycle == 1 else None
        """What `at` returns for each step, with the next step relative, if it is always the same: a
        caller at a high rate then need not call it. None otherwise."""

    def at(self, step: int) -> Due:
        """The tasks due at a step, in order, and the next step with due tasks."""
        place = step % self._cycle
        met = self._met.get(place)
        if met is None:
            # Unusual rates produce long cycles.
            if len(self._met) >= _KEPT:
                self._met.clear()
            met = self._met[place] = self._look(step)
        first, last, gap = met
        return first, last, step + gap

    def skip(self, step: int, limit: int) -> int:
        """The first step from `step` on at which a due task is not idle, or one from `limit` on.

        Args:
            step: A step with due tasks.
            limit: Where to stop looking.
        """
        idle: tuple[Task, ...] = ()
        while step < limit:
            first, last, upcoming = self.at(step)
            if last:
                return step
            # Tasks that are due together are one tuple.
            if first is not idle:
                for task in first:
                    if task.idle is None or not task.idle():
                        return step
                idle = first
            step = upcoming
        return step

    def _look(self, step: int) -> Due:
        due, bit, upcoming = 0, 1, step + NEVER
        for ticks in self._ticks:
            if ticks.due(step) == step:
                due |= bit
            upcoming = min(upcoming, ticks.due(step + 1))
            bit <<= 1
        tasks = self._together.get(due)
        if tasks is None:
            periods = {ticks.period for i, ticks in enumerate(self._ticks) if due >> i & 1}
            together = [task for task, period in self._tasks if period in periods]
            last = tuple(t for t in together if t.before is None and t.active is always)
            tasks = tuple(t for t in together if t not in last), last
            self._together[due] = tasks
        return *tasks, upcoming - step
