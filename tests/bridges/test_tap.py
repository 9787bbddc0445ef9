"""What a tap passes on of what is published, however late its thread is."""

from collections import deque
from collections.abc import Callable
from typing import Any

from cartwheel.bridges.tap import Tap
from cartwheel.codes.wires import PUBLISHED_TOO_FAST
from cartwheel.errors import Diagnostic
from cartwheel.graph import Graph, Publisher
from cartwheel.messages import message_class


class Hand:
    """A loop that is turned by hand."""

    def __init__(self) -> None:
        self.functions: deque[Callable[[], None]] = deque()

    def post(self, function: Callable[[], None]) -> None:
        self.functions.append(function)

    def turn(self) -> None:
        while self.functions:
            self.functions.popleft()()


class Tapped:
    """A topic whose messages come to a list."""

    def __init__(self, kind: str) -> None:
        self.graph = Graph()
        self.publisher: Publisher = self.graph.advertise("/topic", kind)
        self.loop = Hand()
        self.taken: list[Any] = []
        self.reports: list[Diagnostic] = []

    def open(self) -> Tap:
        made = Tap(
            self.loop,  # type: ignore[arg-type]
            self.graph,
            topic="/topic",
            type_name=self.publisher.type,
            reader="test",
            ignored=lambda _: False,
            take=self.taken.append,
            warn=self.reports.append,
        )
        made.open()
        return made


def test_what_is_too_much_is_counted() -> None:
    tapped = Tapped("std_msgs/msg/String")
    made = tapped.open()
    for number in range(230):
        tapped.publisher.publish(message_class("std_msgs/msg/String")(data=str(number)))
    tapped.loop.turn()
    assert [message.data for message in tapped.taken] == [str(n) for n in range(30, 230)]
    assert made.dropped == 30
    (report,) = tapped.reports
    assert (report.code, report.values) == (PUBLISHED_TOO_FAST, {"topic": "/topic"})
