"""A timer with a better resolution than the loop's milliseconds."""

from __future__ import annotations

import contextlib
import ctypes
import os
import struct
import sys
from collections.abc import Callable

from rtps_lite.interface import READ, EventLoop

_MONOTONIC, _FLAGS = 1, os.O_NONBLOCK | os.O_CLOEXEC


class Alarm:
    """Calls a function once after a delay. Used on the loop's thread.

    Without system timers that can be polled, it has the resolution of the loop.

    Args:
        loop: Event loop.
    """

    def __init__(self, loop: EventLoop) -> None:
        self._loop = loop
        self._ring: Callable[[], None] = lambda: None
        self._set = False
        self._file = -1
        if sys.platform == "linux":
            self._system = ctypes.CDLL(None, use_errno=True)
            self._file = self._system.timerfd_create(_MONOTONIC, _FLAGS)

    def fileno(self) -> int:
        """File descriptor of the system timer."""
        return self._file

    def start(self, ring: Callable[[], None]) -> None:
        """Starts watching the timer, and calls `ring` each time it expires."""
        self._ring = ring
        if self._file >= 0:
            self._loop.watch(self, READ, self._ready)

    def after(self, seconds: float) -> None:
        """Sets the timer, unless it is already set."""
        if self._set:
            return
        self._set = True
        if self._file < 0:
            self._loop.after(seconds, self._done)
            return
        # An interval of zero means once. A time of zero would disable the timer.
        whole = int(seconds)
        rest = max(1, int((seconds - whole) * 1e9))
        self._system.timerfd_settime(self._file, 0, struct.pack("4q", 0, 0, whole, rest), None)

    def close(self) -> None:
        """Closes the timer."""
        if self._file >= 0:
            self._loop.forget(self)
            os.close(self._file)
            self._file = -1

    def _ready(self, _: int) -> None:
        self._done()
        if not self._set and self._file >= 0:
            # An expired timer stays readable until it is read or set again.
            with contextlib.suppress(BlockingIOError):
                os.read(self._file, 8)

    def _done(self) -> None:
        self._set = False
        self._ring()
