"""Attempts to reach other nodes, on few threads."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable

THREADS = 16
_PER_HOST = 4
_HOPELESS = 2
"""Of both one in so many is for what was in vain the last time."""

Attempt = Callable[[], None]


class Attempts:
    """Runs what may take long; hosts that do not answer hold up no others.

    All hosts have their turns, each with a few attempts at a time. What was in vain the last time
    has half of the threads at most.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._waiting: dict[str, deque[tuple[Attempt, bool]]] = {}
        """By host: attempts, and whether the last one was in vain."""
        self._busy: dict[str, int] = {}
        self._hopeless: dict[str, int] = {}
        self._threads = 0
        self._closed = False

    def add(self, host: str, attempt: Attempt, *, hopeless: bool) -> None:
        """Runs an attempt when it is its turn; from any thread, and at once.

        Args:
            host: That it tries to reach.
            attempt: Takes a bounded time.
            hopeless: Whether the same was in vain the last time.
        """
        with self._lock:
            if self._closed:
                return
            queue = self._waiting.setdefault(host, deque())
            if hopeless:
                queue.append((attempt, True))
            else:
                queue.appendleft((attempt, False))
            if self._threads >= THREADS:
                return
            self._threads += 1
        threading.Thread(target=self._run, name="ros1 connect", daemon=True).start()

    def close(self) -> None:
        """Begins no further attempt."""
        with self._lock:
            self._closed = True
            self._waiting.clear()

    def _run(self) -> None:
        while True:
            with self._lock:
                found = self._next()
                if found is None:
                    # Whoever is busy with what stands in the way of the rest takes that.
                    self._threads -= 1
                    return
            host, attempt, hopeless = found
            try:
                attempt()
            finally:
                with self._lock:
                    self._count(self._busy, host, -1)
                    if hopeless:
                        self._count(self._hopeless, host, -1)

    def _next(self) -> tuple[str, Attempt, bool] | None:
        """The attempt whose turn it is; the caller holds the lock."""
        for host, queue in self._waiting.items():
            attempt, hopeless = queue[0]
            if self._busy.get(host, 0) >= _PER_HOST or (hopeless and not self._hopes(host)):
                continue
            queue.popleft()
            # To the end: the others come first now.
            del self._waiting[host]
            if queue:
                self._waiting[host] = queue
            self._count(self._busy, host, 1)
            if hopeless:
                self._count(self._hopeless, host, 1)
            return host, attempt, hopeless
        return None

    def _hopes(self, host: str) -> bool:
        """Whether one more attempt may be made for what was in vain."""
        return (
            sum(self._hopeless.values()) < THREADS // _HOPELESS
            and self._hopeless.get(host, 0) < _PER_HOST // _HOPELESS
        )

    @staticmethod
    def _count(counts: dict[str, int], host: str, more: int) -> None:
        counts[host] = counts.get(host, 0) + more
        if not counts[host]:
            del counts[host]
