"""Queue of messages to be written. It is bounded, and never drops messages."""

from __future__ import annotations

import threading
import time
from collections import deque
from dataclasses import dataclass
from typing import Any

from cartwheel.bridges.packed import Packed

ROOM = 64 << 20
"""Approximate maximum size of queued messages in bytes."""
COUNT = 20_000
"""Maximum number of queued messages."""
_BATCH = 1000
"""Number of queued messages at which the reader is woken at once."""
_LINGER = 0.02
"""Interval in s at which the reader takes the queued messages."""
_SMALL = 256
"""Approximate size of a message in bytes, without its large arrays."""


@dataclass(frozen=True, slots=True)
class Item:
    """A message with its topic."""

    topic: str
    type: str
    latched: bool
    time_ns: int
    message: Any
    begins: bool
    """Whether time jumped back before this message, so that a new file begins."""


class Backlog:
    """A queue whose writer waits while it is full."""

    def __init__(self, *, room: int = ROOM, count: int = COUNT) -> None:
        self._room = room
        self._count = count
        self._batch = max(1, min(_BATCH, count // 2))
        self._items: deque[tuple[Item, int]] = deque()
        self._size = 0
        self._changed = threading.Condition()
        self._open = True
        self.waited = 0.0
        """Wall time in s for which `put` has waited."""

    def put(self, item: Item) -> None:
        """Adds an item as soon as there is space. Does nothing after `close`."""
        size = size_of(item.message)
        with self._changed:
            if self._is_full and self._open:
                begin = time.perf_counter()
                self._changed.wait_for(lambda: not self._is_full or not self._open)
                self.waited += time.perf_counter() - begin
            if self._open:
                self._items.append((item, size))
                self._size += size
                if len(self._items) == self._batch or self._size > self._room // 4:
                    self._changed.notify_all()

    def get(self, timeout: float) -> list[Item]:
        """Returns the queued items, at most `_LINGER` s after the first was added.

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
            items = [item for item, _ in self._items]
            self._items.clear()
            return items

    def done(self, items: list[Item]) -> None:
        """Releases the space of items that were written."""
        with self._changed:
            self._size -= sum(size_of(item.message) for item in items)
            self._changed.notify_all()

    @property
    def is_open(self) -> bool:
        return self._open

    def close(self) -> None:
        """Rejects new items. Queued items can still be read."""
        with self._changed:
            self._open = False
            self._changed.notify_all()

    @property
    def _is_due(self) -> bool:
        return len(self._items) >= self._batch or self._size > self._room // 4

    @property
    def _is_full(self) -> bool:
        return self._size >= self._room or len(self._items) >= self._count


def size_of(message: Any) -> int:
    """Approximate size of a message in bytes: the sum of its large arrays."""
    if isinstance(message, Packed):
        return _SMALL + len(message.cdr)
    size = _SMALL
    for name in ("data", "ranges", "intensities"):
        size += getattr(getattr(message, name, None), "nbytes", 0)
    return size
