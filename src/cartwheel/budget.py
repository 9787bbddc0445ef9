"""Rate limits for events."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable


class Budget:
    """Limits events to a burst and a long-term rate. Thread-safe.

    Args:
        most: Maximum number of events in a burst.
        rate: Long-term rate, Hz.
        clock: Current time, ns; by default wall time. It may jump back, as simulation time does
            after a reset.
    """

    def __init__(self, most: int, rate: float, clock: Callable[[], int] | None = None) -> None:
        self._most, self._rate = most, rate
        self._clock = clock or time.monotonic_ns
        self._left, self._since_ns = float(most), self._clock()
        self._lock = threading.Lock()

    def take(self) -> bool:
        """Counts an event if the budget allows it; returns whether it does."""
        with self._lock:
            now_ns = self._clock()
            passed = max(0, now_ns - self._since_ns) / 1e9
            self._left = min(self._most, self._left + passed * self._rate)
            self._since_ns = now_ns
            if self._left < 1.0:
                return False
            self._left -= 1.0
            return True
