"""Rate limits for events."""

from __future__ import annotations

import threading
import time


class Budget:
    """Limits events to a burst and a long-term rate. Thread-safe.

    Args:
        most: Maximum number of events in a burst.
        rate: Long-term rate, Hz.
    """

    def __init__(self, most: int, rate: float) -> None:
        self._most, self._rate = most, rate
        self._left, self._since = float(most), time.monotonic()
        self._lock = threading.Lock()

    def take(self) -> bool:
        """Counts an event if the budget allows it; returns whether it does."""
        with self._lock:
            now = time.monotonic()
            self._left = min(self._most, self._left + (now - self._since) * self._rate)
            self._since = now
            if self._left < 1.0:
                return False
            self._left -= 1.0
            return True
