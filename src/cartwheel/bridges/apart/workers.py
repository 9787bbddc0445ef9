"""A bounded pool of threads for slow work."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable

THREADS, WAITING = 64, 1000
"""Maximum number of running jobs and of queued jobs."""


class Workers:
    """Runs jobs on threads, which end when the queue is empty. Shutdown does not wait for them.

    Args:
        name: Name of the threads.
    """

    def __init__(self, name: str) -> None:
        self._name = name
        self._lock = threading.Lock()
        self._jobs: deque[Callable[[], None]] = deque()
        self._count = 0

    def run(self, job: Callable[[], None]) -> bool:
        """Queues a job, which must not raise. Returns False if the queue is full. Thread-safe."""
        with self._lock:
            if len(self._jobs) >= WAITING:
                return False
            self._jobs.append(job)
            if self._count >= THREADS:
                return True
            self._count += 1
        threading.Thread(target=self._work, name=self._name, daemon=True).start()
        return True

    def _work(self) -> None:
        while True:
            with self._lock:
                if not self._jobs:
                    self._count -= 1
                    return
                job = self._jobs.popleft()
            job()
