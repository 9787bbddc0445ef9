"""Queue of messages to be written. It is bounded, and never drops messages."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Any

ROOM = 64 << 20
"""Approximate maximum size of queued messages in bytes."""
COUNT = 20_000
"""Maximum number of queued messages."""
_BATCHES = 20
"""The reader is woken at once at this part of the room."""
_LINGER = 0.02
"""Interval in s at which the reader takes the queued messages."""
WIDTH = 3
"""Number of values of a message in the list that `Backlog.get` returns."""


class Backlog:
    """A queue whose writer waits while it is full. It has one writer and one reader.

    A message is three successive values of one list, which Python appends in one operation. Thus
    neither thread locks the list, and no object is made that Python's garbage collector visits.
    Each message counts as its size and the part of the room that bounds the number of messages.

    Args:
        room: Approximate maximum size of the queued messages in bytes.
        count: Maximum number of queued messages.
        on_wait: Called after `put` has waited, with the total time in s.
    """

    def __init__(
        self,
        *,
        room: int = ROOM,
        count: int = COUNT,
        on_wait: Callable[[float], None] = lambda _: None,
    ) -> None:
        self._room = room
        self._each = -(-room // count)
        self._batch = max(1, room // _BATCHES)
        self._on_wait = on_wait
        self._items: list[Any] = []
        self._put = 0
        """Bytes that were put so far; changed only by the writer."""
        self._written = 0
        """Bytes of the messages that were written; changed only by the reader."""
        self._limit = min(self._batch, room)
        """Value of `_put` at which the writer wakes the reader, and waits if the queue is full."""
        self._called = False
        """Whether the reader was woken for the messages in the queue."""
        self._changed = threading.Condition()
        self.is_open = True
        self.waited = 0.0
        """Wall time in s for which `put` has waited."""

    def put(self, number: int, time_ns: int, data: bytes | str) -> None:
        """Adds a message as soon as there is space. Does nothing after `close`.

        Args:
            number: Number of its topic.
            time_ns: Its time.
            data: Its bytes.
        """
        put = self._put
        if put >= self._limit and not self._call():
            return
        self._put = put + len(data) + self._each
        self._items.extend((number, time_ns, data))

    def get(self, timeout: float) -> list[Any]:
        """Returns the queued messages, at most `_LINGER` s after the first was added: for each
        message its number, its time and its data.

        Returns an empty list after `timeout` s or once closed.

        The reader is not woken for each message, because switching between two threads at every
        message increases the total time by half.
        """
        deadline = time.monotonic() + timeout
        with self._changed:
            # The writer calls before it adds a message, whose predecessors may have been returned.
            while self.is_open and not (self._called and self._items):
                left = min(deadline - time.monotonic(), _LINGER)
                if left <= 0:
                    break
                if not self._changed.wait(left) and self._items:
                    break
            self._called = False
        # The writer may append meanwhile.
        count = len(self._items)
        taken = self._items[:count]
        del self._items[:count]
        return taken

    def done(self, data: list[bytes | str]) -> None:
        """Releases the space of messages that were written."""
        size = sum(map(len, data)) + len(data) * self._each
        with self._changed:
            self._written += size
            self._changed.notify_all()

    def close(self) -> None:
        """Rejects new messages. Queued messages can still be read."""
        with self._changed:
            self.is_open = False
            self._limit = -1
            self._changed.notify_all()

    def _call(self) -> bool:
        """Wakes the reader, and waits while the queue is full. Returns whether it is open."""
        waited = 0.0
        with self._changed:
            self._called = True
            self._changed.notify_all()
            if self._is_full:
                begin = time.perf_counter()
                self._changed.wait_for(lambda: not self._is_full or not self.is_open)
                waited = time.perf_counter() - begin
            is_open = self.is_open
            if is_open:
                self._limit = min(self._put + self._batch, self._written + self._room)
        if waited:
            self.waited += waited
            self._on_wait(self.waited)
        return is_open

    @property
    def _is_full(self) -> bool:
        return self._put - self._written >= self._room
