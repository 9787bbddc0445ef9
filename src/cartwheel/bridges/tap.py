"""Transfer of a topic's messages to the thread of a bridge."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from cartwheel.bridges.bridged import BridgedGraph, BridgedSubscription
from cartwheel.bridges.loop import Loop
from cartwheel.codes.wires import PUBLISHED_TOO_FAST
from cartwheel.errors import Diagnostic
from cartwheel.graph import Mailbox

_WAITING = 200
"""Maximum number of queued messages between the simulation's and the bridge's threads."""


class Tap:
    """Subscribes to a topic only while it is open, so that unused messages are not made.

    Args:
        loop: Event loop on whose thread messages are handled.
        graph: Graph with the topic.
        topic: Topic name in the graph.
        type_name: Message type.
        reader: Node name of the bridge.
        ignored: Whether a message came from this bridge, and so must not be sent back.
        take: Called with each message.
        warn: Receives warnings.
        beyond: Returns the number of messages dropped after `take`. Callable on any thread.
    """

    def __init__(
        self,
        loop: Loop,
        graph: BridgedGraph,
        *,
        topic: str,
        type_name: str,
        reader: str,
        ignored: Callable[[Any], bool],
        take: Callable[[Any], None],
        warn: Callable[[Diagnostic], None],
        beyond: Callable[[], int] = lambda: 0,
    ) -> None:
        self._loop = loop
        self._graph = graph
        self._topic = topic
        self._type_name = type_name
        self._reader = reader
        self._ignored = ignored
        self._take = take
        self._warn = warn
        self._beyond = beyond
        self._box = Mailbox(_WAITING)
        self._due = False
        self._late = False
        self._subscription: BridgedSubscription | None = None

    @property
    def dropped(self) -> int:
        """Number of messages dropped because the bridge or its subscribers were too slow."""
        return self._box.dropped + self._beyond()

    def open(self) -> None:
        """Subscribes, unless already subscribed."""
        if self._subscription is None:
            self._subscription = self._graph.subscribe(
                self._topic, self._put, type_name=self._type_name, node=self._reader
            )
            self._subscription.dropped = lambda: self.dropped

    def close(self) -> None:
        """Unsubscribes."""
        if self._subscription is not None:
            self._subscription.close()
            self._subscription = None
        self._box.drain()

    def _put(self, message: Any) -> None:
        """Called on the simulation's thread."""
        if self._ignored(message):
            return
        self._box.put(message)
        if not self._due:
            self._due = True
            self._loop.post(self._pass_on)

    def _pass_on(self) -> None:
        self._due = False
        for message in self._box.drain():
            if self._subscription is not None:
                self._take(message)
        if self._box.dropped and not self._late:
            self._late = True
            self._warn(
                PUBLISHED_TOO_FAST.diagnostic(
                    f"{self._topic} is published faster than it can be sent, so messages are "
                    "dropped",
                    values={"topic": self._topic},
                )
            )
