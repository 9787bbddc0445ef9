"""Event loop thread for all connections of a bridge.

asyncio is not used. Importing it would delay the first ``/clock`` message by 15 to 24 ms, because
the simulation's process needs the loop as well. Its `call_soon_threadsafe` also releases Python's
lock, which the woken thread then takes: posting a function takes 28 to 61 µs on average with
asyncio, and 20 µs here. The CPU time of the bridges is the same.
"""

from __future__ import annotations

import contextlib
import ctypes
import heapq
import itertools
import selectors
import socket
import threading
import time
from collections import deque
from collections.abc import Callable
from concurrent.futures import Future
from typing import Protocol, TypeVar

from cartwheel.calls import answered

READ, WRITE = selectors.EVENT_READ, selectors.EVENT_WRITE
_CHUNK = 1 << 18

# Like `os.write`, but without releasing Python's lock. If the lock were released, the woken
# loop would take it, and the posting thread would wait for the loop's work: 0.5 ms for a message
# on three wires.
_write = ctypes.PyDLL(None).write
_write.argtypes = (ctypes.c_int, ctypes.c_char_p, ctypes.c_size_t)
_write.restype = ctypes.c_ssize_t

T = TypeVar("T")
Ready = Callable[[int], None]


class Watchable(Protocol):
    """A socket, or a different file that can be polled."""

    def fileno(self) -> int:
        """File descriptor."""

    def close(self) -> None:
        """Closes the file."""


class Loop:
    """Waits for sockets, functions from other threads, and timers.

    Args:
        on_fault: Called with the exceptions of functions. The loop continues.
        name: Name of the thread.
    """

    def __init__(self, on_fault: Callable[[Exception], None], *, name: str) -> None:
        self._on_fault = on_fault
        self._selector = selectors.DefaultSelector()
        self._functions: deque[Callable[[], None]] = deque()
        self._timers: list[tuple[float, int, Callable[[], None]]] = []
        self._order = itertools.count()
        self._inner, self._outer = socket.socketpair()
        self._inner.setblocking(False)
        self._outer.setblocking(False)
        self._woken = False
        self._waking = threading.RLock()
        """Held while `_outer` is written to or closed, because its file descriptor may be reused
        after closing.

        It is reentrant, because a signal handler may post while its thread does.
        """
        self._running = True
        self._selector.register(self._inner, READ, self._rouse)
        self._thread = threading.Thread(target=self._run, name=name, daemon=True)

    def start(self) -> None:
        """Starts the thread."""
        self._thread.start()

    def stop(self) -> None:
        """Stops the thread soon. Callable on any thread."""

        def end() -> None:
            self._running = False

        self.post(end)
        if self._thread.is_alive() and threading.current_thread() is not self._thread:
            self._thread.join(1.0)

    # -- from any thread

    def post(self, function: Callable[[], None]) -> None:
        """Runs a function on the loop's thread, without waiting."""
        self._functions.append(function)
        if not self._woken:
            self._woken = True
            with self._waking:
                # This has no effect if the buffer is full of such bytes, or the loop has ended.
                _write(self._outer.fileno(), b"\0", 1)

    def call(self, function: Callable[[], T]) -> Future[T]:
        """Like `post`, with a future of the result or error."""
        return answered(self.post, function)

    # -- on the loop's thread

    def after(self, seconds: float, function: Callable[[], None]) -> None:
        """Runs a function after a delay."""
        heapq.heappush(self._timers, (time.monotonic() + seconds, next(self._order), function))

    def watch(self, sock: Watchable, events: int, ready: Ready) -> None:
        """Calls `ready` with those of `events` for which a socket is ready."""
        try:
            self._selector.modify(sock, events, ready)
        except KeyError:
            self._selector.register(sock, events, ready)

    def forget(self, sock: Watchable) -> None:
        """Stops watching a socket."""
        with contextlib.suppress(KeyError, ValueError):
            self._selector.unregister(sock)

    def _run(self) -> None:
        while self._running:
            for key, events in self._selector.select(self._patience()):
                self._guarded(lambda ready=key.data, events=events: ready(events))  # type: ignore[misc]
            self._woken = False
            for _ in range(len(self._functions)):
                self._guarded(self._functions.popleft())
            now = time.monotonic()
            while self._timers and self._timers[0][0] <= now:
                self._guarded(heapq.heappop(self._timers)[2])
        for key in list(self._selector.get_map().values()):
            key.fileobj.close()  # type: ignore[union-attr]
        self._selector.close()
        with self._waking:
            self._outer.close()

    def _patience(self) -> float | None:
        if self._functions:
            return 0.0
        if self._timers:
            return max(0.0, self._timers[0][0] - time.monotonic())
        return None

    def _guarded(self, function: Callable[[], None]) -> None:
        try:
            function()
        except Exception as error:  # noqa: BLE001 - one error must not stop the others
            self._on_fault(error)

    def _rouse(self, _: int) -> None:
        with contextlib.suppress(BlockingIOError):
            self._inner.recv(4096)


class Coalesced:
    """Runs a function once after a delay, however often it is called in the meantime.

    Used on the loop's thread.

    Args:
        loop: Event loop.
        seconds: Delay in s.
        function: Function to run.
    """

    def __init__(self, loop: Loop, seconds: float, function: Callable[[], None]) -> None:
        self._loop = loop
        self._seconds = seconds
        self._function = function
        self._due = False

    def __call__(self) -> None:
        """Schedules the function, unless it is already scheduled."""
        if not self._due:
            self._due = True
            self._loop.after(self._seconds, self._run)

    def _run(self) -> None:
        self._due = False
        self._function()


def taken(sock: socket.socket, size: int = _CHUNK) -> bytes | None:
    """Received bytes: empty at the end of the connection, None if no data is available.

    Args:
        sock: Non-blocking socket.
        size: Maximum number of bytes.
    """
    try:
        return sock.recv(size)
    except BlockingIOError:
        return None
    except OSError:
        return b""
