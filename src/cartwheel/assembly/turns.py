"""Access to a simulation by one thread at a time."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Callable, Iterator

from cartwheel.calls import Post
from cartwheel.codes.world import WORLD_FORKED
from cartwheel.errors import SimulationError

_LOOK = 0.05
"""Interval in s at which a waiting thread checks whether the holder shares its turn."""
_ENTRY = 1.0
"""Maximum wall time in s for which the holder waits for a thread that it lets in."""


class Turns:
    """A reentrant lock. Its holder can let other threads in between two steps of a long run."""

    def __init__(self) -> None:
        self._lock = threading.RLock()
        self._post: Post | None = None
        self._abandoned = False
        self.runner: int | None = None
        """The thread of the current run; None if there is none."""

    def abandon(self) -> None:
        """Refuses all later turns. A thread that does not exist after a fork may hold the lock."""
        self._abandoned = True

    def check(self) -> None:
        """Raises the error of an abandoned lock.

        Raises:
            SimulationError: This process was forked while the simulation was connected.
        """
        if self._abandoned:
            # The threads and processes behind the connections do not exist here, so a wait for them
            # would not end.
            raise SimulationError(
                "a connected world cannot be used in a forked process",
                code=WORLD_FORKED,
                hint="Create a world in the forked process.",
            )

    def __enter__(self) -> Turns:
        # The state of a world is read at a high rate, and the lock is usually free.
        if self._abandoned or not self._lock.acquire(blocking=False):
            self.acquire()
        return self

    def __exit__(self, *_: object) -> None:
        self._lock.release()

    def acquire(self) -> None:
        """Waits for the turn of this thread.

        Raises:
            SimulationError: This process was forked while the simulation was connected.
        """
        if not self._abandoned and self._lock.acquire(blocking=False):
            return
        self.check()
        entered = threading.Event()
        asked: Post | None = None
        try:
            while not self._lock.acquire(timeout=_LOOK):
                post = self._post
                if post is not None and post is not asked:
                    asked = post
                    post(lambda: self._let_in(entered))
        finally:
            entered.set()

    def acquire_within(self, seconds: float) -> bool:
        """Waits for the end of the holder's run. Returns whether this thread has its turn."""
        return self._lock.acquire(timeout=seconds)

    def release(self) -> None:
        """Ends the turn of this thread."""
        self._lock.release()

    @contextlib.contextmanager
    def shared(self, post: Callable[[Callable[[], None]], None]) -> Iterator[None]:
        """Lets other threads in during the block.

        Args:
            post: Queues a function for this thread, which has its turn.
        """
        before, self._post = self._post, post
        try:
            yield
        finally:
            self._post = before

    def _let_in(self, entered: threading.Event) -> None:
        if entered.is_set():
            return
        self._lock.release()
        try:
            entered.wait(_ENTRY)
        finally:
            self._lock.acquire()
