"""Queue of messages to be written. It is bounded, and never drops messages."""

from __future__ import annotations

import threading
import time
from collections import deque
from typing import Generic, TypeVar

T = TypeVar("T")

ROOM = 64 << 20
"""Approximate maximum size of queued messages in bytes."""
COUNT = 20_000
"""Maximum number of queued messages."""
_BATCH = 1000
"""Number of queued messages at which the reader is woken at once."""
_LINGER = 0.02
"""Interval in s at which the reader takes the queued messages."""
_SMALL = 256
"""Approximate size of a queued message in bytes, without its data."""


class Backlog(Generic[T]):
    """A queue whose writer waits while it is full. It has one writer and one reader.

    The two do not share a lock while the queue is neither full nor awaited. A count of bytes is
    changed by only one of them.

    Args:
        room: Approximate maximum size of the queued items in bytes.
        count: Maximum number of queued items.
    """

    def __init__(self, *, room: int = ROOM, count: int = COUNT) -> None:
        self._room = room
        self._count = count
        self._batch = max(1, min(_BATCH, count // 2))
        self._items: deque[tuple[T, int]] = deque()
        self._put = 0
        """Bytes that were put so far."""
        self._written = 0
        """Bytes of the items that were written."""
        self._called = False
        """Whether the reader was woken for the items in the queue."""
        self._changed = threading.Condition()
        self._open = True
        self.waited = 0.0
        """Wall time in s for which `put` has waited."""

    def put(self, item: T, size: int) -> None:
        """Adds an item as soon as there is space. Does nothing after `close`.

        Args:
            item: The item.
            size: Size of its data in bytes.
        """
        items, waiting = self._items, self._put - self._written
        if waiting >= self._room or len(items) >= self._count:
            self._wait()
        if not self._open:
            return
        size += _SMALL
        self._put += size
        items.append((item, size))
        # This is `_is_due` inlined, which saves a call per message.
        if (len(items) >= self._batch or waiting + size > self._room // 4) and not self._called:
            with self._changed:
                self._called = True
                self._changed.notify_all()

    def get(self, timeout: float) -> list[tuple[T, int]]:
        """Returns the queued items with their sizes, at most `_LINGER` s after the first was added.

        Returns an empty list after `timeout` s or once closed.

        The reader is not woken for each message, because switching between two threads at every
        message increases the total time by half.
        """
        deadline = time.monotonic() + timeout
        with self._changed:
            while self._open and not self._is_due:
                left = min(deadline - time.monotonic(), _LINGER)
                if left <= 0:
                    break
                waited = not self._changed.wait(left)
                if waited and self._items:
                    break
            self._called = False
            # The writer may append meanwhile.
            return [self._items.popleft() for _ in range(len(self._items))]

    def done(self, size: int) -> None:
        """Releases the space of items that were written: the sum of their sizes from `get`."""
        with self._changed:
            self._written += size
            self._changed.notify_all()

    @property
    def is_open(self) -> bool:
        return self._open

    def close(self) -> None:
        """Rejects new items. Queued items can still be read."""
        with self._changed:
            self._open = False
            self._changed.notify_all()

    def _wait(self) -> None:
        begin = time.perf_counter()
        with self._changed:
            self._called = True
            self._changed.notify_all()
            self._changed.wait_for(lambda: not self._is_full or not self._open)
        self.waited += time.perf_counter() - begin

    @property
    def _is_due(self) -> bool:
        return len(self._items) >= self._batch or self._put - self._written > self._room // 4

    @property
    def _is_full(self) -> bool:
        return self._put - self._written >= self._room or len(self._items) >= self._count
