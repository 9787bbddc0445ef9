"""What of a graph a bridge offers to others, and what it asks them for."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import Any

from cartwheel.bridges.bridged import BridgedGraph
from cartwheel.codes.graph import SERVICE_TIMED_OUT
from cartwheel.codes.wires import INCOMING_DROPPED, MALFORMED_MESSAGE
from cartwheel.errors import CartwheelError, Diagnostic, GraphError
from cartwheel.graph import TopicInfo

BRIDGES = frozenset({"ros1", "ros2"})
"""What bridges are called as nodes of the graph."""
ONLOOKERS = frozenset({"viewer", "cartwheel topic", "recorder", "foxglove"})
"""Nodes of the graph that read what it publishes, and expect nothing of other publishers."""
_BACKLOG = 1000
_BACKLOG_BYTES = 128 << 20
"""Messages from outside that the simulation has not taken yet."""

_CALL = 120.0
"""s that the simulation may take to answer a service."""


@dataclass(slots=True)
class Survey:
    """Topics by the names that others know."""

    sent: dict[str, TopicInfo] = field(default_factory=dict)
    """What somebody here publishes."""
    read: dict[str, TopicInfo] = field(default_factory=dict)
    """What somebody here wants to hear from outside."""


def survey(
    topics: Iterable[TopicInfo],
    *,
    outer: Callable[[str], str] = lambda name: name,
    known: Callable[[TopicInfo], bool] = lambda _: True,
) -> Survey:
    """Sorts topics of the graph.

    Args:
        topics: All of them.
        outer: Gives the name outside.
        known: Whether the type exists outside.
    """
    found = Survey()
    for info in topics:
        if not known(info):
            continue
        name = outer(info.name)
        if info.publishers:
            found.sent.setdefault(name, info)
        readers = set(info.subscribers) - BRIDGES
        if readers and (not info.publishers or readers - ONLOOKERS):
            found.read.setdefault(name, info)
    return found


def offered_by_others(graph: BridgedGraph, reader: str) -> dict[str, TopicInfo]:
    """Topics by name, but for those that none but `reader` still reads."""
    return {
        info.name: info
        for info in graph.topics()
        if info.publishers or set(info.subscribers) - {reader}
    }


def asked(graph: BridgedGraph, service: str, request: Any) -> Any:
    """The response of a service; from any thread but the simulation's, which is waited for.

    Raises:
        CartwheelError: There is no such service, it refused, or there was no answer in time.
    """
    future = graph.call(service, request)
    try:
        return future.result(_CALL)
    except TimeoutError:
        future.cancel()
        raise GraphError(
            f"the simulation did not respond to {service} within {_CALL:g} s",
            code=SERVICE_TIMED_OUT,
            values={"service": service, "seconds": _CALL},
        ) from None


class Arrivals:
    """Messages from outside on their way into the graph; they are not sent back.

    Args:
        graph: Where they go.
        tell: Takes a warning.
    """

    def __init__(self, graph: BridgedGraph, tell: Callable[[Diagnostic], None]) -> None:
        self._graph = graph
        self._tell = tell
        self._under_way: dict[int, Any] = {}
        self._bytes = 0
        self._counting = threading.Lock()

    def __contains__(self, message: object) -> bool:
        return id(message) in self._under_way

    def deliver(self, topic: str, type_name: str, message: Any, *, size: int = 0) -> None:
        """Publishes a message in the graph; from any thread.

        Args:
            topic: Its name in the graph.
            type_name: Of the message.
            message: As the graph has it.
            size: In bytes, as far as that is known.
        """
        if len(self._under_way) >= _BACKLOG or self._bytes + size > _BACKLOG_BYTES:
            self._tell(
                INCOMING_DROPPED.diagnostic(
                    "ROS nodes send messages faster than the simulation processes them, so some "
                    "messages are dropped"
                )
            )
            return
        self._under_way[id(message)] = message
        self._count(size)
        try:
            self._graph.publish(topic, type_name, message)
        except CartwheelError as error:
            self._tell(
                MALFORMED_MESSAGE.because(
                    f"a message on {topic} is ignored", error, values={"topic": topic}
                )
            )

        def taken() -> None:
            self._under_way.pop(id(message), None)
            self._count(-size)

        self._graph.post(taken)

    def _count(self, size: int) -> None:
        with self._counting:
            self._bytes += size
