"""A timer that is finer than the millisecond in which a loop waits."""

from __future__ import annotations

import contextlib
import ctypes
import os
import struct
import sys
from collections.abc import Callable

from cartwheel.bridges.loop import READ, Loop

_MONOTONIC, _FLAGS = 1, os.O_NONBLOCK | os.O_CLOEXEC


class Alarm:
    """Calls a function once, some time after it is set; on the loop's thread.

    Where the system has no timers that can be watched, it is as fine as the loop.

    Args:
        loop: Waits for it.
    """

    def __init__(self, loop: Loop) -> None:
        self._loop = loop
        self._ring: Callable[[], None] = lambda: None
        self._set = False
        self._file = -1
        if sys.platform == "linux":
            self._system = ctypes.CDLL(None, use_errno=True)
            self._file = self._system.timerfd_create(_MONOTONIC, _FLAGS)

    def fileno(self) -> int:
        """Of the system's timer."""
        return self._file

    def start(self, ring: Callable[[], None]) -> None:
        """Begins to watch, and calls `ring` each time."""
        self._ring = ring
        if self._file >= 0:
            self._loop.watch(self, READ, self._ready)

    def after(self, seconds: float) -> None:
        """Sets it, unless it is set already."""
        if self._set:
            return
        self._set = True
        if self._file < 0:
            self._loop.after(seconds, self._done)
            return
        # An interval of zero is once; a time of zero would be never.
        whole = int(seconds)
        rest = max(1, int((seconds - whole) * 1e9))
        self._system.timerfd_settime(self._file, 0, struct.pack("4q", 0, 0, whole, rest), None)

    def close(self) -> None:
        """Ends it."""
        if self._file >= 0:
            self._loop.forget(self)
            os.close(self._file)
            self._file = -1

    def _ready(self, _: int) -> None:
        self._done()
        if not self._set and self._file >= 0:
            # One that is set anew is not ready any more; this one would be for ever.
            with contextlib.suppress(BlockingIOError):
                os.read(self._file, 8)

    def _done(self) -> None:
        self._set = False
        self._ring()
