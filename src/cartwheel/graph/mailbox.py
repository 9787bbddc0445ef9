"""A bounded queue between the simulation's thread and a slower reader."""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable
from typing import Generic

from cartwheel.messages.typed import M

TIMEOUT = 30.0
"""Default time for which `Mailbox.get` waits, s."""
_LOOK = 1.0
"""Interval in s at which `can_come` is checked."""


class Mailbox(Generic[M]):
    """Stores the newest messages for one reader. When full, it drops and counts the oldest.

    Args:
        size: Capacity in messages; 1 stores only the latest.
        can_come: Whether a message may still arrive while the calling thread waits.
    """

    def __init__(self, size: int, *, can_come: Callable[[], bool] | None = None) -> None:
        self._can_come = can_come
        self._messages: deque[M] = deque(maxlen=size)
        self._condition = threading.Condition()
        self._closed = False
        self.dropped = 0
        """Number of messages dropped because the reader was too slow."""
        self.on_close: Callable[[], None] = lambda: None

    def put(self, message: M) -> None:
        """Adds a message without waiting."""
        with self._condition:
            if len(self._messages) == self._messages.maxlen:
                self.dropped += 1
            self._messages.append(message)
            self._condition.notify()

    def get(self, timeout: float = TIMEOUT) -> M | None:
        """Returns the oldest unread message as soon as one is available.

        Args:
            timeout: Maximum time to wait in s of wall time.

        Returns:
            None after the timeout, when the mailbox is closed, or when no message can arrive.
        """
        end = time.monotonic() + timeout
        with self._condition:
            while not self._messages and not self._closed:
                left = end - time.monotonic()
                if left <= 0:
                    break
                if self._can_come is not None:
                    if not self._can_come():
                        break
                    left = min(left, _LOOK)
                self._condition.wait(left)
            return self._messages.popleft() if self._messages else None

    def drain(self) -> list[M]:
        """Returns all unread messages, oldest first, without waiting."""
        with self._condition:
            messages = list(self._messages)
            self._messages.clear()
            return messages

    @property
    def closed(self) -> bool:
        return self._closed

    def close(self) -> None:
        """Ends the subscription and wakes the reader."""
        self.on_close()
        with self._condition:
            self._closed = True
            self.on_close = lambda: None
            self._can_come = None
            self._condition.notify_all()
