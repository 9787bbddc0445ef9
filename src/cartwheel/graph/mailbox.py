"""A bounded queue between the simulation's thread and a slower reader."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable
from typing import Any


class Mailbox:
    """Holds the newest messages for one reader; a full one drops its oldest and counts it.

    Args:
        size: How many messages to hold; 1 keeps the latest alone.
    """

    def __init__(self, size: int) -> None:
        self._messages: deque[Any] = deque(maxlen=size)
        self._condition = threading.Condition()
        self._closed = False
        self.dropped = 0
        """Messages that went unread because the reader was too slow."""
        self.on_close: Callable[[], None] = lambda: None

    def put(self, message: Any) -> None:
        """Adds a message; never waits."""
        with self._condition:
            if len(self._messages) == self._messages.maxlen:
                self.dropped += 1
            self._messages.append(message)
            self._condition.notify()

    def get(self, timeout: float | None = None) -> Any | None:
        """The oldest unread message; None when `timeout` seconds pass or the mailbox closes."""
        with self._condition:
            self._condition.wait_for(lambda: self._messages or self._closed, timeout)
            return self._messages.popleft() if self._messages else None

    def drain(self) -> list[Any]:
        """All unread messages, oldest first, without waiting."""
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
            self._condition.notify_all()
