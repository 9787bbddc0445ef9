"""Lockstep: simulation time waits for the commands of a stack under test.

Time advances by one period and stops. The messages of the period are sent meanwhile. Time continues
when one message has arrived on each command topic. Until then, commands are kept back, so they take
effect at the same simulation time in each run, however fast the stack under test is.
"""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from types import TracebackType
from typing import Any, Self

from cartwheel.api.arguments import several
from cartwheel.api.exchange.faults import FaultyWorld
from cartwheel.api.values import invalid, scalar
from cartwheel.codes.command import COMMAND_EXTRA, COMMAND_LATE, COMMAND_MISSING
from cartwheel.errors import TimedOutError
from cartwheel.graph.holding import hold_back, let_pass
from cartwheel.simulation.clock import NANOSECONDS
from cartwheel.simulation.limits import duration_ns

PERIOD = 0.1
WALL_TIMEOUT = 5.0
START_TIMEOUT = 60.0
_RETRY = 1.0
"""Wall time after which time advances by a period before the first commands, s. Until a stack
under test has connected all its topics, it may have missed a message. A stack that needed longer
to connect has as much time."""
_STILL = 0.5
"""Wall time without a new subscription after which a stack under test is connected, s."""
_ALONE = 5.0
"""Wall time to wait for the first messages in a world that no other program can reach, s. They may
come from another thread."""
_QUIET = 2.0
"""Wall time without a command after which all commands of the start have arrived, s.

A stack that needed longer for its first command has as much time for each further one."""
_MOST = 100
"""Maximum number of commands that are kept back for a topic."""
_TIME_ERROR = 1e-9
_OF_CONNECTIONS = "CW8"
"""The codes of diagnostics of connections begin with it."""
_MOST_WARNINGS = 5
"""Maximum number of warnings in an error."""


class SteppedWorld(FaultyWorld):
    """The part of `World` that runs in lockstep."""

    def lockstep(
        self,
        commands: str | Sequence[str],
        *,
        period: float = PERIOD,
        wall_timeout: float = WALL_TIMEOUT,
        start_timeout: float = START_TIMEOUT,
        check: Callable[[], None] | None = None,
    ) -> Lockstep:
        """Runs the world in lockstep with another program from now on, such as a node of ROS.

        In `run`, `step` and `run_until`, simulation time then stops after each period until a
        message has arrived on each command topic. The messages take effect at that time, so runs
        are repeatable, however fast the other program is. The lockstep ends with
        `Lockstep.close`, or with a ``with`` block.

        The first of these calls waits for the first messages, and raises a `TimedOutError` if they
        do not arrive within `start_timeout`.

        Args:
            commands: Topics on which the other program publishes once in each period.
            period: Simulation time between two messages of a topic, s.
            wall_timeout: Wall time after which time continues without a message, s.
            start_timeout: Wall time to wait for the first messages, s.
            check: Called while the simulation waits; raises an error if the other program has
                ended.

        Raises:
            UnknownNameError: A topic does not exist.
            CartwheelError: A time is not above 0, no topic is given, or the world already runs in
                lockstep.
            SimulationError: The world is closed.
        """
        topics = several(commands, "commands")
        if not topics:
            raise invalid("commands", "must be one or several topics", commands)
        times = {"period": period, "wall_timeout": wall_timeout, "start_timeout": start_timeout}
        for name, seconds in times.items():
            scalar(seconds, name, above=0.0)
        self._check_open()
        if self._advancer is not None:
            error = invalid("lockstep", "must end before another one begins", topics)
            error.hint = "Use it in a with block."
            raise error
        made = Lockstep(
            self,
            topics,
            period=period,
            wall_timeout=wall_timeout,
            start_timeout=start_timeout,
            check=check,
        )
        self._advancer = made.advance
        return made

    def _end(self) -> None:
        self._advancer = None
        super()._end()


def _nothing() -> None:
    """The program under test is not checked."""


class Lockstep:
    """Runs a connected world in lockstep with a stack under test; see `World.lockstep`.

    Args:
        world: The world.
        commands: The command topics.
        period: Simulation time between two messages of a topic, s.
        wall_timeout: Wall time after which time continues without a message, s.
        start_timeout: Wall time to wait for the first messages, s.
        check: Called while the simulation waits; raises an error if the stack has ended.
    """

    def __init__(
        self,
        world: SteppedWorld,
        commands: Sequence[str],
        *,
        period: float = PERIOD,
        wall_timeout: float = WALL_TIMEOUT,
        start_timeout: float = START_TIMEOUT,
        check: Callable[[], None] | None = None,
    ) -> None:
        self._world = world
        self._simulation = world.session.simulation
        self._period, self._wall_timeout = period, wall_timeout
        self._start_timeout, self._check = start_timeout, check or _nothing
        self._lock = threading.Lock()
        commands = [world.graph.topic(name).name for name in commands]
        self._boxes: dict[str, deque[Any]] = {name: deque(maxlen=_MOST) for name in commands}
        self._deliver: dict[str, Callable[[Any], None]] = {}
        self._due = self._now
        self._begun = False
        self._reported: set[str] = set()
        """Topics with several messages in a period."""
        self.late = 0
        """Number of periods in which a message was missing."""
        self.extra = 0
        """Number of messages that were replaced by a newer one of the same period."""
        self.missing: Mapping[str, float] = {}
        """Topics of the first late message, with the simulation time, s."""
        for name in commands:
            self._deliver[name] = hold_back(world.graph, name, self._taker(name))

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if error is not None and self.late:
            topic, when = next(iter(self.missing.items()))
            error.add_note(
                f"lockstep: {self.late} periods without a message in time, the first one on "
                f"{topic} at {when:.3f} s"
            )
        self.close()

    def close(self) -> None:
        """Delivers messages at once again."""
        for name in self._deliver:
            let_pass(self._world.session.graph, name)
        if self._world._advancer == self.advance:
            self._world._advancer = None

    @property
    def _now(self) -> float:
        """Simulation time, s."""
        return self._simulation.time_ns / NANOSECONDS

    def _run(self, seconds: float) -> None:
        self._world._run_freely(duration_ns(seconds))

    def _taker(self, topic: str) -> Callable[[Any], None]:
        def take(message: Any) -> None:
            """Called on any thread."""
            with self._lock:
                self._boxes[topic].append(message)
            self._simulation.post(lambda: None)

        return take

    def start(self) -> None:
        """Waits for the first message on each command topic.

        The stack under test usually sends a command for each message of a sensor. It cannot have
        received a message that was published before it subscribed. So time stands still until the
        stack has subscribed to its topics, and then advances by one period each time that no
        command has arrived for a while. A slow stack may then send several commands.

        Raises:
            TimedOutError: No message has arrived on a topic in time.
        """
        begin = time.monotonic()
        alone = self._world._connections is None
        patience = min(self._start_timeout, _ALONE) if alone else self._start_timeout
        end = begin + patience
        if not alone:
            self._connect(begin + patience / 2)
        connected = time.monotonic()
        retry = max(_RETRY, connected - begin)
        periods = 0
        while not self._complete():
            # In a connected stack, nothing happens before the first period.
            if (periods or alone) and self._wait(min(retry, end - time.monotonic())):
                break
            if time.monotonic() >= end:
                raise self._missing(patience, alone=alone)
            periods += 1
            self._run(self._period)
        if periods:
            took = min(time.monotonic() - connected, self._wall_timeout)
            self._settle(periods + 1, max(_QUIET, took))
        self._release()
        self._begun = True
        self._due = self._now

    def _connect(self, end: float) -> None:
        """Waits until the stack under test reads topics of the simulation, or has sent commands.

        Args:
            end: When to go on all the same, on the monotonic clock, s.
        """
        before, changed = self._read_topics(), time.monotonic()
        while not self._complete() and (now := time.monotonic()) < end:
            if before and now >= changed + _STILL:
                return
            self._wait(min(0.1, end - now))
            topics = self._read_topics()
            if topics != before:
                before, changed = topics, time.monotonic()

    def _read_topics(self) -> set[str]:
        """The topics that nodes of ROS read."""
        from cartwheel.bridges.mirror import BRIDGES

        return {
            each.name
            for each in self._world.session.graph.topics()
            if not BRIDGES.isdisjoint(each.subscribers)
        }

    def _missing(self, seconds: float, *, alone: bool) -> TimedOutError:
        """The error for a stack under test that has sent no command.

        Args:
            seconds: The wall time of the wait.
            alone: Whether the world is not connected.
        """
        with self._lock:
            topics = [topic for topic, box in self._boxes.items() if not box]
        read = tuple(sorted(self._read_topics()))
        warnings = [
            each
            for each in self._world.session.diagnostics
            if each.code.number.startswith(_OF_CONNECTIONS)
        ][-_MOST_WARNINGS:]
        if alone:
            hint = "The world is not connected. Call connect_ros2() or connect_ros1() before."
        else:
            topic = ", ".join(read) or "no topic of the simulation"
            # Such as those of topics that a node cannot receive because of its quality of service.
            reported = [f"{each.message} [{each.code.number}]." for each in warnings]
            hint = " ".join([f"Other nodes read {topic}.", *reported])
        return TimedOutError(
            f"no message arrived on {', '.join(topics)} within {seconds:g} s of wall time, so the "
            "lockstep did not begin",
            code=COMMAND_MISSING,
            hint=hint,
            values={
                "topics": tuple(topics),
                "timeout": seconds,
                "connected": not alone,
                "read": read,
                "warnings": tuple(each.code.number for each in warnings),
            },
        )

    def _settle(self, most: int, quiet: float) -> None:
        """Waits for further commands of the start.

        Otherwise, a command that answers an earlier period would be taken for that of the next one,
        and each command after it as well, or not, depending on how fast the stack is.

        Args:
            most: Maximum number of commands for each topic.
            quiet: Wall time to wait for each further command, s.
        """
        most = min(most, _MOST)
        counts = self._counts()
        end = time.monotonic() + quiet
        while min(counts) < most and (left := end - time.monotonic()) > 0:
            self._check()
            with self._world._used() as simulation:
                simulation.wait(min(left, 0.5))
            before, counts = counts, self._counts()
            if counts != before:
                end = time.monotonic() + quiet

    def _counts(self) -> list[int]:
        with self._lock:
            return [len(box) for box in self._boxes.values()]

    def advance(self, seconds: float) -> None:
        """Advances simulation time, and waits for commands at each end of a period."""
        if not self._begun:
            self.start()
        end = self._now + seconds
        while self._now < end - _TIME_ERROR:
            if self._now >= self._due + self._period - _TIME_ERROR:
                self._due += self._period
                if not self._wait(self._wall_timeout):
                    self._note_late()
                self._release()
            step = min(end, self._due + self._period) - self._now
            self._run(max(step, self._simulation.step_ns * 1e-9))

    def _complete(self) -> bool:
        with self._lock:
            return all(self._boxes.values())

    def _wait(self, seconds: float) -> bool:
        """Waits for a message on each topic, and serves other requests meanwhile."""
        end = time.monotonic() + seconds
        while not self._complete():
            left = end - time.monotonic()
            if left <= 0:
                return False
            self._check()
            with self._world._used() as simulation:
                simulation.wait(min(left, 0.5))
        return True

    def _release(self) -> None:
        """Delivers the commands of the period."""
        for topic, box in self._boxes.items():
            with self._lock:
                message = box.pop() if box else None
                replaced = len(box)
                box.clear()
            self.extra += replaced
            if message is not None:
                self._deliver[topic](message)
            if replaced and self._begun and topic not in self._reported:
                self._reported.add(topic)
                self._note_extra(topic, replaced + 1)

    def _note_late(self) -> None:
        self.late += 1
        with self._lock:
            missing = [topic for topic, box in self._boxes.items() if not box]
        now = self._now
        if not self.missing:
            self.missing = dict.fromkeys(missing, now)
        self._simulation.report(
            COMMAND_LATE.diagnostic(
                f"no message arrived on {', '.join(missing)} within {self._wall_timeout:g} s of "
                f"wall time, so simulation time continued at {now:.3f} s without it",
                values={"topics": tuple(missing), "time": now},
            )
        )

    def _note_extra(self, topic: str, count: int) -> None:
        now = self._now
        self._simulation.report(
            COMMAND_EXTRA.diagnostic(
                f"{count} messages arrived on {topic} in the period that ended at {now:.3f} s; "
                "the newest one has taken effect",
                hint="Set `period` to the time between two messages.",
                values={"topic": topic, "count": count, "time": now},
            )
        )
