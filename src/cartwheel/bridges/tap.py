"""A topic of the graph on its way to a bridge's thread."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from cartwheel.bridges.bridged import BridgedGraph, BridgedSubscription
from cartwheel.bridges.loop import Loop
from cartwheel.codes.wires import PUBLISHED_TOO_FAST
from cartwheel.errors import Diagnostic
from cartwheel.graph import Mailbox

_WAITING = 200
"""Messages that may wait between the simulation's thread and ours."""


class Tap:
    """Subscribes to one topic of the graph while it is open, so that nothing is made for nobody.

    Args:
        loop: Takes the messages on its thread.
        graph: Where the topic is.
        topic: Its name there.
        type_name: Of its messages.
        reader: By which we subscribe.
        ignored: Whether a message came from outside in the first place.
        take: Takes each message.
        tell: Takes a warning.
        beyond: How many messages were dropped after they were taken; asked on any thread.
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
        tell: Callable[[Diagnostic], None],
        beyond: Callable[[], int] = lambda: 0,
    ) -> None:
        self._loop = loop
        self._graph = graph
        self._topic = topic
        self._type_name = type_name
        self._reader = reader
        self._ignored = ignored
        self._take = take
        self._tell = tell
        self._beyond = beyond
        self._box = Mailbox(_WAITING)
        self._due = False
        self._late = False
        self._subscription: BridgedSubscription | None = None

    @property
    def dropped(self) -> int:
        """Messages that were published faster than they could be sent, or than others read."""
        return self._box.dropped + self._beyond()

    def open(self) -> None:
        """Subscribes, where that is not done yet."""
        if self._subscription is None:
            self._subscription = self._graph.subscribe(
                self._topic, self._put, type_name=self._type_name, node=self._reader
            )
            self._subscription.dropped = lambda: self.dropped

    def close(self) -> None:
        """Leaves the graph."""
        if self._subscription is not None:
            self._subscription.close()
            self._subscription = None
        self._box.drain()

    def _put(self, message: Any) -> None:
        """On the simulation's thread."""
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
            self._tell(
                PUBLISHED_TOO_FAST.diagnostic(
                    f"{self._topic} is published faster than it can be sent, so messages are "
                    "dropped",
                    values={"topic": self._topic},
                )
            )
