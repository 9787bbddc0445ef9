"""Selection of what a bridge offers of the graph, and delivery of external messages."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol, TypeVar

from cartwheel.bridges.bridged import BridgedGraph
from cartwheel.codes.graph import SERVICE_TIMED_OUT
from cartwheel.codes.wires import INCOMING_DROPPED, MALFORMED_MESSAGE, TYPE_UNSUPPORTED
from cartwheel.errors import CartwheelError, Diagnostic, GraphError, UnknownNameError
from cartwheel.graph import TopicInfo

BRIDGES = frozenset({"ros1", "ros2"})
"""Names of bridges as nodes of the graph."""
ONLOOKERS = frozenset({"viewer", "cartwheel topic", "recorder", "foxglove"})
"""Nodes of the graph that only observe it. They do not need messages from external publishers."""
_BACKLOG = 1000
_BACKLOG_BYTES = 128 << 20
"""Maximum bytes of external messages that the simulation has not processed yet."""

_CALL = 120.0
"""Timeout in s for the simulation's response to a service call."""


class Closable(Protocol):
    """What a bridge offers: a topic, a subscription, a service or an action."""

    def close(self) -> None:
        """Removes it."""


C = TypeVar("C", bound=Closable)


class Copies(dict[str, C]):
    """External copies of the graph's topics, services or actions, by external name."""

    def __init__(self) -> None:
        super().__init__()
        self.properties: dict[str, Any] = {}
        """Properties of each original as of the copy's creation."""

    def synchronise(self, originals: Mapping[str, Any], create: Callable[[str, Any], C]) -> None:
        """Closes copies whose original has changed or is gone, and creates the missing ones.

        Copies that were added in a different way stay.

        Args:
            originals: Properties by name. A copy is replaced if these are no longer equal.
            create: Creates the copy of an original, from its name and properties.
        """
        for name, properties in list(self.properties.items()):
            if originals.get(name) != properties:
                del self.properties[name]
                self.pop(name).close()
        for name, properties in originals.items():
            if name not in self:
                self[name] = create(name, properties)
                self.properties[name] = properties


def is_available(
    kind: str,
    name: str,
    type_name: str,
    *,
    ros: str,
    find: Callable[[str], object],
    warn: Callable[[Diagnostic], None],
) -> bool:
    """Whether a version of ROS has the type of a topic or service; otherwise warns.

    Args:
        kind: "topic" or "service".
        name: Name of the topic or service.
        type_name: Its type.
        ros: Name of the version of ROS.
        find: Finds a type, or raises an `UnknownNameError`.
        warn: Receives the warning.
    """
    try:
        find(type_name)
    except UnknownNameError:
        warn(
            TYPE_UNSUPPORTED.diagnostic(
                f"{kind} {name} is not available in {ros}, which has no type {type_name}",
                values={kind: name, "type": type_name},
            )
        )
        return False
    return True


@dataclass(slots=True)
class Survey:
    """Topics by their external names."""

    sent: dict[str, TopicInfo] = field(default_factory=dict)
    """Topics with a publisher in the graph."""
    read: dict[str, TopicInfo] = field(default_factory=dict)
    """Topics with a subscriber in the graph that needs external messages."""


def survey(
    topics: Iterable[TopicInfo],
    *,
    outer: Callable[[str], str] = lambda name: name,
    known: Callable[[TopicInfo], bool] = lambda _: True,
) -> Survey:
    """Sorts the topics of a graph.

    Args:
        topics: All topics of the graph.
        outer: Returns the external name of a topic.
        known: Whether the type exists externally.
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
    """Topics by name, without topics that exist only because `reader` subscribes to them."""
    return {
        info.name: info
        for info in graph.topics()
        if info.publishers or set(info.subscribers) - {reader}
    }


def asked(graph: BridgedGraph, service: str, request: Any) -> Any:
    """Calls a service and returns its response. Not allowed on the simulation's thread.

    Raises:
        CartwheelError: The service does not exist, it refused, or it timed out.
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
    """External messages that are published on the graph. They are not sent back.

    Args:
        graph: Graph to publish on.
        warn: Receives warnings.
    """

    def __init__(self, graph: BridgedGraph, warn: Callable[[Diagnostic], None]) -> None:
        self._graph = graph
        self._warn = warn
        self._under_way: dict[int, Any] = {}
        self._bytes = 0
        self._counting = threading.Lock()

    def __contains__(self, message: object) -> bool:
        return id(message) in self._under_way

    def deliver(self, topic: str, type_name: str, message: Any, *, size: int = 0) -> None:
        """Publishes a message on the graph. Callable on any thread.

        Args:
            topic: Topic name in the graph.
            type_name: Message type.
            message: Message of the graph's class.
            size: Size in bytes, if known.
        """
        if len(self._under_way) >= _BACKLOG or self._bytes + size > _BACKLOG_BYTES:
            self._warn(
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
            self._warn(
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
