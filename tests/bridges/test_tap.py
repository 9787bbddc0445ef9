"""What a tap passes on of what is published, however late its thread is."""

from collections import deque
from collections.abc import Callable
from typing import Any

import pytest

from cartwheel.bridges import tap
from cartwheel.bridges.tap import Tap
from cartwheel.graph import Graph, Publisher
from cartwheel.messages import message_class, stamp


class Hand:
    """A loop that is turned by hand, and the clock on the wall."""

    def __init__(self) -> None:
        self.now = 0.0
        self.functions: deque[Callable[[], None]] = deque()
        self.later: list[tuple[float, Callable[[], None]]] = []

    def monotonic(self) -> float:
        return self.now

    def post(self, function: Callable[[], None]) -> None:
        self.functions.append(function)

    def after(self, seconds: float, function: Callable[[], None]) -> None:
        self.later.append((self.now + seconds, function))

    def turn(self) -> None:
        due = [function for when, function in self.later if when <= self.now]
        self.later = [(when, function) for when, function in self.later if when > self.now]
        for function in due:
            function()
        while self.functions:
            self.functions.popleft()()


class Tapped:
    """A topic whose messages come to a list."""

    def __init__(self, kind: str) -> None:
        self.graph = Graph()
        self.publisher: Publisher = self.graph.advertise("/topic", kind)
        self.loop = Hand()
        self.taken: list[Any] = []
        self.told: list[str] = []

    def open(self) -> Tap:
        made = Tap(
            self.loop,  # type: ignore[arg-type]
            self.graph,
            topic="/topic",
            type_name=self.publisher.type,
            reader="test",
            ignored=lambda _: False,
            take=self.taken.append,
            tell=self.told.append,
        )
        made.open()
        return made


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Tapped:
    tapped = Tapped("rosgraph_msgs/msg/Clock")
    monkeypatch.setattr(tap, "time", tapped.loop)
    return tapped


def _publish(tapped: Tapped, times: range) -> None:
    for tick in times:
        message = message_class("rosgraph_msgs/msg/Clock")(clock=stamp(tick * 10**7))
        tapped.publisher.publish(message)


def _ticks(tapped: Tapped) -> list[int]:
    return [round((m.clock.sec * 10**9 + m.clock.nanosec) / 10**7) for m in tapped.taken]


def test_each_time_is_passed_on_in_real_time(clock: Tapped) -> None:
    made = clock.open()
    for tick in range(1000):
        clock.loop.now = tick * 0.01
        _publish(clock, range(tick, tick + 1))
        clock.loop.turn()
    assert _ticks(clock) == list(range(1000))
    assert not made.dropped


def test_each_time_is_passed_on_after_the_thread_stood_still(clock: Tapped) -> None:
    clock.open()
    _publish(clock, range(100))
    clock.loop.now = 1.0
    clock.loop.turn()
    assert _ticks(clock) == list(range(100))


def test_of_times_at_full_speed_the_newest_are_passed_on(clock: Tapped) -> None:
    made = clock.open()
    # 20,000 in a second of wall time, ten at each turn of the loop.
    for turn in range(2000):
        clock.loop.now = turn / 2000
        _publish(clock, range(10 * turn, 10 * turn + 10))
        clock.loop.turn()
    clock.loop.now = 1.01
    clock.loop.turn()
    ticks = _ticks(clock)
    assert ticks == sorted(set(ticks))
    assert ticks[-1] == 19_999
    assert 1000 <= len(ticks) <= 100 + 1010
    # Who waits for a time does not wait long: as many went in each tenth of the second.
    assert all(any(2000 * n <= tick < 2000 * (n + 1) for tick in ticks) for n in range(10))
    assert not made.dropped
    assert not clock.told


def test_what_is_no_time_is_counted_where_it_is_too_much() -> None:
    tapped = Tapped("std_msgs/msg/String")
    made = tapped.open()
    for number in range(130):
        tapped.publisher.publish(message_class("std_msgs/msg/String")(data=str(number)))
    tapped.loop.turn()
    assert [message.data for message in tapped.taken] == [str(n) for n in range(30, 130)]
    assert made.dropped == 30
    assert tapped.told == ["/topic is published faster than it can be sent: messages are dropped"]
