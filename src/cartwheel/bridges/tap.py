"""A topic of the graph on its way to a bridge's thread."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

from cartwheel.bridges.loop import Loop
from cartwheel.graph import Graph, Mailbox, Subscription

_WAITING = 100
"""Messages that may wait between the simulation's thread and ours."""
_CLOCK = "rosgraph_msgs/msg/Clock"
_TIMES, _TIMES_AT_ONCE = 1000.0, 100.0
"""Times that are sent in a second, and at once: a simulation at full speed publishes many more, and
each is read by every node that uses simulated time."""
_SOON = 0.001
"""s after which times that may not be sent yet are looked at again."""


class Tap:
    """Subscribes to one topic of the graph while it is open, so that nothing is made for nobody.

    Of times that come faster than anybody can use them, the newest are passed on: an old one is
    no loss. All other messages are.

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
        graph: Graph,
        *,
        topic: str,
        type_name: str,
        reader: str,
        ignored: Callable[[Any], bool],
        take: Callable[[Any], None],
        tell: Callable[[str], None],
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
        self._allowance = _Allowance() if type_name == _CLOCK else None
        self._subscription: Subscription | None = None

    @property
    def dropped(self) -> int:
        """Messages that were published faster than they could be sent, or than others read."""
        return self._overrun + self._beyond()

    @property
    def _overrun(self) -> int:
        return 0 if self._allowance is not None else self._box.dropped

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
        allowed = None if self._allowance is None else self._allowance.left()
        if allowed == 0:
            self._loop.after(_SOON, self._pass_on)
            return
        self._due = False
        messages = self._box.drain()
        if self._allowance is not None and allowed is not None:
            messages = messages[-allowed:]
            self._allowance.spend(len(messages))
        for message in messages:
            if self._subscription is not None:
                self._take(message)
        if self._overrun and not self._late:
            self._late = True
            self._tell(
                f"{self._topic} is published faster than it can be sent: messages are dropped"
            )


class _Allowance:
    """How many times may be sent: so many in a second of wall time, and so many at once."""

    def __init__(self) -> None:
        self._left = _TIMES_AT_ONCE
        self._since = time.monotonic()

    def left(self) -> int:
        """How many may be sent now."""
        now = time.monotonic()
        self._left = min(_TIMES_AT_ONCE, self._left + (now - self._since) * _TIMES)
        self._since = now
        return int(self._left)

    def spend(self, count: int) -> None:
        """They are sent."""
        self._left -= count
