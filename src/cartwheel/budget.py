"""How often something may happen."""

from __future__ import annotations

import threading
import time


class Budget:
    """Allows a number of events at once, and a rate in the long run; from any thread.

    Args:
        most: Events at once.
        rate: Hz in the long run.
    """

    def __init__(self, most: int, rate: float) -> None:
        self._most, self._rate = most, rate
        self._left, self._since = float(most), time.monotonic()
        self._lock = threading.Lock()

    def take(self) -> bool:
        """Whether an event may happen now; it counts then."""
        with self._lock:
            now = time.monotonic()
            self._left = min(self._most, self._left + (now - self._since) * self._rate)
            self._since = now
            if self._left < 1.0:
                return False
            self._left -= 1.0
            return True
