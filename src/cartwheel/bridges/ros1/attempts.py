"""Connection attempts to other nodes, on a few threads."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable

THREADS = 16
_PER_HOST = 4
_HOPELESS = 2
"""Divisor: retries of failed attempts use at most half of both limits."""

Attempt = Callable[[], None]


class Attempts:
    """Runs slow connection attempts. Hosts that do not respond do not delay other hosts.

    Hosts take turns, with a limited number of attempts each. Retries of failed attempts use at
    most half of the threads.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._waiting: dict[str, deque[tuple[Attempt, bool]]] = {}
        """By host: attempts, and whether each is a retry of a failed attempt."""
        self._busy: dict[str, int] = {}
        self._hopeless: dict[str, int] = {}
        self._threads = 0
        self._closed = False

    def add(self, host: str, attempt: Attempt, *, hopeless: bool) -> None:
        """Queues an attempt. Returns at once. Callable on any thread.

        Args:
            host: Host to connect to.
            attempt: Connects within a bounded time.
            hopeless: Whether the previous attempt failed.
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
        """Starts no more attempts."""
        with self._lock:
            self._closed = True
            self._waiting.clear()

    def _run(self) -> None:
        while True:
            with self._lock:
                found = self._next()
                if found is None:
                    # The threads that use up the limits will run the remaining attempts.
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
        """Selects the next attempt. The caller holds the lock."""
        for host, queue in self._waiting.items():
            attempt, hopeless = queue[0]
            if self._busy.get(host, 0) >= _PER_HOST or (hopeless and not self._hopes(host)):
                continue
            queue.popleft()
            # Move the host to the end, so that the other hosts come first.
            del self._waiting[host]
            if queue:
                self._waiting[host] = queue
            self._count(self._busy, host, 1)
            if hopeless:
                self._count(self._hopeless, host, 1)
            return host, attempt, hopeless
        return None

    def _hopes(self, host: str) -> bool:
        """Whether a failed attempt may be retried now."""
        return (
            sum(self._hopeless.values()) < THREADS // _HOPELESS
            and self._hopeless.get(host, 0) < _PER_HOST // _HOPELESS
        )

    @staticmethod
    def _count(counts: dict[str, int], host: str, more: int) -> None:
        counts[host] = counts.get(host, 0) + more
        if not counts[host]:
            del counts[host]
