"""What waits to be written: bounded, and never dropped."""

from __future__ import annotations

import threading
import time
from collections import deque
from dataclasses import dataclass
from typing import Any

from cartwheel.bridges.packed import Packed

ROOM = 64 << 20
"""Bytes of messages, about, that may wait."""
COUNT = 20_000
"""Messages that may wait."""
_BATCH = 1000
"""Messages for which the reader is woken at once."""
_LINGER = 0.02
"""s that messages lie before they are taken."""
_SMALL = 256
"""Bytes of a message but for its large array, about."""


@dataclass(frozen=True, slots=True)
class Item:
    """A message and what it is one of."""

    topic: str
    type: str
    latched: bool
    time_ns: int
    message: Any
    begins: bool
    """Time went back before it: a new file begins."""


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
        """s of wall time that `put` has waited."""

    def put(self, item: Item) -> None:
        """Adds an item as soon as there is room; nothing once it is closed."""
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
        """What waits, within `_LINGER` s of its coming; empty after `timeout` s or once closed.

        Its reader is not woken for each message: two threads that take turns at every message
        take half as long again for all of them.
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
        """They are written, and their room is free again."""
        with self._changed:
            self._size -= sum(size_of(item.message) for item in items)
            self._changed.notify_all()

    @property
    def is_open(self) -> bool:
        return self._open

    def close(self) -> None:
        """Takes no more; what waits can still be got."""
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
    """About how many bytes a message holds: those of the arrays that grow large."""
    if isinstance(message, Packed):
        return _SMALL + len(message.cdr)
    size = _SMALL
    for name in ("data", "ranges", "intensities"):
        size += getattr(getattr(message, name, None), "nbytes", 0)
    return size
