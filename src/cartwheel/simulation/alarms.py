"""Actions at times of the simulation, once or at a rate."""

from __future__ import annotations

import heapq
import math
from collections.abc import Callable, Sequence
from fractions import Fraction

from cartwheel.simulation.clock import NEVER
from cartwheel.simulation.engine import Engine


class Alarm:
    """An action at a time, or repeatedly at a fixed period.

    Args:
        action: Runs before the step that starts at the time.
        time_ns: The time. A time within a step is handled at the next step.
        period_ns: Time between two calls; None for a single call.
    """

    def __init__(
        self, action: Callable[[], None], time_ns: int, period_ns: Fraction | None = None
    ) -> None:
        self.action = action
        self.time_ns = time_ns
        self._start_ns = time_ns
        self._period_ns = period_ns
        self.pending = True
        """Whether the action runs in the future."""

    @property
    def repeats(self) -> bool:
        """Whether the action runs more than once."""
        return self._period_ns is not None

    def restart(self, now_ns: int) -> None:
        """Starts the periods again at a time."""
        self.time_ns = self._start_ns = now_ns

    @property
    def times(self) -> tuple[int, int]:
        """The next time, and the time from which the periods are counted."""
        return self.time_ns, self._start_ns

    def resume(self, time_ns: int, start_ns: int) -> bool:
        """Makes the action pending again at saved `times`; returns False if it was cancelled."""
        if self.action is _nothing:
            return False
        self.time_ns, self._start_ns, self.pending = time_ns, start_ns, True
        return True

    def pass_by(self, now_ns: int) -> None:
        """Moves to the next time after `now_ns`; a single action has none."""
        if self._period_ns is None:
            self.pending = False
            return
        count = (now_ns - self._start_ns) // self._period_ns + 1
        self.time_ns = self._start_ns + math.ceil(count * self._period_ns)

    def cancel(self) -> None:
        """Removes the action. Does nothing if it has run or was removed."""
        self.pending = False
        self.action = _nothing


class Alarms:
    """The pending actions of a simulation, at no cost while there are none.

    Actions that are due in the same step run in the order of their times, and then in the order in
    which they were added. Use it only on the simulation's thread.

    Args:
        engine: The engine with the time.
        failed: Called with the error of an action.
    """

    def __init__(self, engine: Engine, failed: Callable[[BaseException], None]) -> None:
        self._engine = engine
        self._failed = failed
        self._queue: list[tuple[int, int, Alarm]] = []
        self._added = 0
        self.active = False
        """Whether `serve` has anything to do."""

    @property
    def pending(self) -> tuple[Alarm, ...]:
        """The actions that will run, in order."""
        return tuple(alarm for *_, alarm in sorted(self._queue) if alarm.pending)

    def add(self, alarm: Alarm) -> Alarm:
        """Adds an action. One whose time has passed is due in the next step."""
        heapq.heappush(self._queue, (alarm.time_ns, self._added, alarm))
        self._added += 1
        self.active = True
        return alarm

    def serve(self) -> int:
        """Runs the due actions.

        Returns:
            The step of the next action.
        """
        engine, queue = self._engine, self._queue
        rewinds = engine.rewinds
        while queue and (queue[0][0] <= engine.time_ns or not queue[0][2].pending):
            _, number, alarm = heapq.heappop(queue)
            if not alarm.pending:
                continue
            alarm.pass_by(engine.time_ns)
            if alarm.pending:
                heapq.heappush(queue, (alarm.time_ns, number, alarm))
            engine.note_change()
            try:
                alarm.action()
            except (Exception, SystemExit) as error:  # noqa: BLE001 - a user's own
                self._failed(error)
            if engine.rewinds != rewinds:
                break
        self.active = bool(queue)
        return self.next_step()

    def next_step(self) -> int:
        """The step of the next action."""
        engine, queue = self._engine, self._queue
        return engine.step + engine.steps_until(queue[0][0]) if queue else NEVER

    def save(self) -> tuple[tuple[Alarm, int, int], ...]:
        """The pending actions with their times, for `restore`."""
        return tuple((alarm, *alarm.times) for alarm in self.pending)

    def restore(self, saved: Sequence[tuple[Alarm, int, int]]) -> None:
        """Makes saved actions pending again, unless they were cancelled, after time was set.

        Other actions are treated as by `restart`.
        """
        known = {id(alarm) for alarm, *_ in saved}
        # `restart` cancels single actions, and so would cancel saved ones that are still pending.
        self._queue = [each for each in self._queue if id(each[2]) not in known]
        heapq.heapify(self._queue)
        self.restart()
        others = self.pending
        self._queue.clear()
        for alarm, *times in saved:
            if alarm.resume(*times):
                self.add(alarm)
        for alarm in others:
            self.add(alarm)
        self.active = bool(self._queue)

    def restart(self) -> None:
        """Removes single actions and starts all periods again, after time was set."""
        kept = [alarm for *_, alarm in sorted(self._queue) if alarm.pending and alarm.repeats]
        for *_, alarm in self._queue:
            if not alarm.repeats:
                alarm.cancel()
        self._queue.clear()
        for alarm in kept:
            alarm.restart(self._engine.time_ns)
            self.add(alarm)
        self.active = bool(self._queue)

    def close(self) -> None:
        """Removes all actions."""
        for *_, alarm in self._queue:
            alarm.cancel()
        self._queue.clear()
        self.active = False


def _nothing() -> None:
    pass
