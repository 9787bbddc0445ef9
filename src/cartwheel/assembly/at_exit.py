"""What must end before the exit handlers of libraries, when the main thread has ended."""

from __future__ import annotations

import contextlib
import os
import threading
from collections.abc import Callable

_LOOK = 0.2
"""Interval in s at which the end of the main thread is checked."""
PATIENCE = 5.0
"""Maximum wall time for a run on another thread to end when the process exits, s."""


_open: dict[object, Callable[[], None]] = {}
"""What ends with the process, and the function that ends it."""
_closer: threading.Thread | None = None
_starting = threading.Lock()


def close_at_exit(one: object, end: Callable[[], None]) -> None:
    """Ends something at the end of the process, unless it is forgotten before.

    Args:
        one: What ends.
        end: Ends it. Called on a thread of its own.
    """
    global _closer
    with _starting:
        _open[one] = end
        if _closer is None or not _closer.is_alive():
            _closer = threading.Thread(target=_close_all, name="closer", daemon=False)
            _closer.start()


def forget(one: object) -> None:
    """Leaves out what has ended."""
    _open.pop(one, None)


def end_thread_if_exiting() -> None:
    """Ends this thread if the main thread has ended, so that `close_at_exit` may be too late.

    Raises:
        SystemExit: The main thread has ended.
    """
    if not threading.main_thread().is_alive():
        raise SystemExit


def only_daemons_are_left() -> bool:
    """Whether no other thread keeps the process alive; called by a function that ends something."""
    ours = (threading.main_thread(), threading.current_thread())
    return all(each.daemon or each in ours for each in threading.enumerate())


def _after_fork() -> None:
    """The parent ends what it has opened. Another thread may have held the lock."""
    global _closer, _starting
    _open.clear()
    _closer = None
    _starting = threading.Lock()


os.register_at_fork(after_in_child=_after_fork)


def _close_all() -> None:
    """Waits for the end of the main thread.

    The interpreter waits for this thread before it calls the functions of `atexit`, with which
    libraries end servers and rendering contexts that are still in use.
    """
    global _closer
    while True:
        threading.main_thread().join(_LOOK)
        with _starting:
            if not _open:
                _closer = None
                return
        if not threading.main_thread().is_alive():
            for one, end in list(_open.items()):
                with contextlib.suppress(Exception):
                    end()
                forget(one)
