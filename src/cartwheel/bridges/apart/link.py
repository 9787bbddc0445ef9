"""Remote function calls between two processes over a socket."""

from __future__ import annotations

import contextlib
import itertools
import pickle
import socket
import struct
import threading
from collections import deque
from collections.abc import Callable
from concurrent.futures import Future
from typing import Any

from cartwheel.bridges.apart.workers import THREADS, WAITING, Workers
from cartwheel.bridges.loop import READ, WRITE, Loop, taken
from cartwheel.codes.wires import BRIDGE_ENDED, BRIDGE_RECOVERED, BRIDGE_SLOW, CALL_LIMIT
from cartwheel.errors import CartwheelError, ControlError, one_line

_LENGTH = struct.Struct("<Q")
_CALL, _NOTIFY, _ANSWER = range(3)
_PATIENCE = 30.0
"""Timeout in s for a response, while the other process may be busy."""

_LOOKS = 5.0
"""Interval in s at which a slow receiver is checked again."""
_LATE = 1 << 20
"""Number of queued bytes from which droppable messages are dropped."""
_MOST = 256 << 20
"""Maximum number of queued bytes. At this limit the link is closed."""
_OVERHEAD = 1 << 10
"""Memory overhead of a queued frame in bytes."""

Handler = Callable[..., Any]


class Link:
    """One end of the connection. Both ends belong to Cartwheel, so the content is trusted.

    Calls arrive in order. A handler runs on the link's thread and must return at once, unless it
    is `threaded`. If it returns a future, the result of the future is the response.

    Args:
        sock: Connected socket.
        name: Name of the thread.
        on_end: Called on the link's thread when the other process has disconnected.
        on_fault: Called with a handler's exception if the caller does not wait for a result.
    """

    def __init__(
        self,
        sock: socket.socket,
        *,
        name: str,
        on_end: Callable[[], None],
        on_fault: Callable[[Exception], None],
    ) -> None:
        self._sock = sock
        self._on_end = on_end
        self._on_fault = on_fault
        self._handlers: dict[str, tuple[Handler, bool]] = {}
        self._waiting: dict[int, Future[Any]] = {}
        self._numbers = itertools.count()
        self._received = bytearray()
        self._workers = Workers(name)
        self._queue: deque[memoryview] = deque()
        self._counting = threading.Lock()
        self._posted = self._sent = 0
        """Bytes queued for the other process, and bytes sent. The receiver and the event loop may
        both be stalled."""
        self._full = False
        self.dropped = 0
        """Number of messages dropped because the queue was too long."""
        self._reported = 0
        """Number of dropped messages that were already reported."""
        self._ended = False
        self.loop = Loop(on_fault, name=name)
        sock.setblocking(False)

    def handle(self, name: str, handler: Handler, *, threaded: bool = False) -> None:
        """Registers a function that the other process may call. Call it before `start`.

        A handler may also be registered later, before the other process learns of it.
        """
        self._handlers[name] = (handler, threaded)

    def start(self) -> None:
        """Starts to receive calls."""
        self.loop.start()
        self.loop.post(lambda: self.loop.watch(self._sock, READ, self._ready))

    def close(self) -> None:
        """Closes the link, after sending queued calls as far as the system accepts them."""
        self.loop.post(self._end)
        self.loop.stop()

    # -- from any thread

    def call(self, name: str, *arguments: Any) -> Future[Any]:
        """Calls a remote function. The future contains its result or error."""
        future: Future[Any] = Future()
        number = next(self._numbers)
        frame = _frame(_CALL, number, name, arguments)

        def send() -> None:
            if self._ended:
                _fail(future, _gone())
                return
            self._waiting[number] = future
            self._write(frame)

        if not self._post(frame, send):
            _fail(future, _gone())
        return future

    def ask(self, name: str, *arguments: Any) -> Any:
        """Calls a remote function and waits for its result. Not allowed on the link's thread.

        Raises:
            Exception: The remote function raised it.
            ControlError: No response arrived in time.
        """
        try:
            return self.call(name, *arguments).result(_PATIENCE)
        except TimeoutError:
            raise ControlError(
                f"the connected process did not respond within {_PATIENCE:g} s",
                code=BRIDGE_SLOW,
                values={"request": name, "seconds": _PATIENCE},
            ) from None

    def notify(self, name: str, *arguments: Any) -> None:
        """Calls a remote function without waiting for a result."""
        frame = _frame(_NOTIFY, 0, name, arguments)
        self._post(frame, lambda: self._write(frame))

    def notify_in_time(self, name: str, *arguments: Any) -> None:
        """Like `notify`, but drops the call if the other process is slow."""
        if self._queued > _LATE:
            with self._counting:
                self.dropped += 1
                is_first = self.dropped == self._reported + 1
            if is_first:
                self.loop.post(self._report_late)
            return
        frame = _frame(_NOTIFY, 0, name, arguments)
        self._post(frame, lambda: self._write(frame))

    @property
    def _queued(self) -> int:
        return self._posted - self._sent

    def _post(self, frame: bytes, write: Callable[[], None]) -> bool:
        """Queues a frame. Returns False if the link is closed or the queue is full."""
        size = len(frame) + _OVERHEAD
        with self._counting:
            if self._full or self._ended:
                return False
            self._full = fills = self._queued + size > _MOST
            if not fills:
                self._posted += size
        self.loop.post(self._give_up if fills else write)
        return not fills

    # -- on the link's thread

    def _write(self, frame: bytes) -> None:
        if self._ended:
            return
        self._queue.append(memoryview(frame))
        if len(self._queue) == 1:
            self._flush()

    def _give_up(self) -> None:
        if self._ended:
            return
        unread = f"{self._queued >> 20} MB"
        self._on_fault(
            ControlError(
                f"the connected process does not read its messages ({unread} are queued), so the "
                "connection is closed",
                code=BRIDGE_SLOW,
            )
        )
        self._end()

    def _report_late(self) -> None:
        """Reports that messages are dropped. `_count_late` reports the number later."""
        if self._ended:
            return
        if self._reported == 0:
            self._on_fault(
                ControlError(
                    "the bridge is too slow, so goal feedback is dropped",
                    code=BRIDGE_SLOW,
                    values={"dropped": "feedback"},
                )
            )
        self.loop.after(_LOOKS, self._count_late)

    def _count_late(self) -> None:
        if self._ended:
            return
        if self._queued > _LATE // 2:
            self.loop.after(_LOOKS, self._count_late)
            return
        with self._counting:
            count, self._reported = self.dropped - self._reported, self.dropped
        self._on_fault(
            ControlError(
                f"the bridge has caught up; {count} feedback messages were dropped",
                code=BRIDGE_RECOVERED,
                values={"dropped": count},
            )
        )

    def _flush(self) -> None:
        while self._queue:
            try:
                count = self._sock.send(self._queue[0])
            except BlockingIOError:
                self.loop.watch(self._sock, READ | WRITE, self._ready)
                return
            except OSError:
                self._end()
                return
            rest = self._queue[0][count:]
            if rest:
                self._queue[0] = rest
            else:
                self._queue.popleft()
                count += _OVERHEAD
            self._sent += count
        self.loop.watch(self._sock, READ, self._ready)

    def _ready(self, events: int) -> None:
        if events & WRITE and not self._ended:
            self._flush()
        if events & READ and not self._ended:
            self._read()

    def _read(self) -> None:
        data = taken(self._sock)
        if data is None:
            return
        if not data:
            self._end()
            return
        received = self._received
        received += data
        start = 0
        while len(received) - start >= _LENGTH.size:
            (length,) = _LENGTH.unpack_from(received, start)
            end = start + _LENGTH.size + length
            if len(received) < end:
                break
            with memoryview(received) as view:
                found = pickle.loads(view[start + _LENGTH.size : end])  # noqa: S301 - sent by Cartwheel
            start = end
            self._take(*found)
        if start:
            del received[:start]

    def _take(self, kind: int, number: int, name: str, content: Any) -> None:
        if kind == _ANSWER:
            future = self._waiting.pop(number, None)
            if future is not None and future.set_running_or_notify_cancel():
                error, value = content
                if error is None:
                    future.set_result(value)
                else:
                    future.set_exception(error)
            return
        handler, threaded = self._handlers[name]
        if not threaded:
            self._run(kind, number, handler, content)
        elif not self._workers.run(lambda: self._run(kind, number, handler, content)):
            busy = ControlError(
                f"{name} is rejected because {THREADS} calls are running and {WAITING} are queued",
                code=CALL_LIMIT,
                values={"name": name, "most": THREADS},
            )
            if kind == _NOTIFY:
                self._on_fault(busy)
            else:
                self._answer(number, busy, None)

    def _run(self, kind: int, number: int, handler: Handler, arguments: Any) -> None:
        try:
            result = handler(*arguments)
        except Exception as error:  # noqa: BLE001 - the caller handles it
            if kind == _NOTIFY:
                self._on_fault(error)
            else:
                self._answer(number, error, None)
            return
        if kind == _NOTIFY:
            return
        if isinstance(result, Future):
            result.add_done_callback(lambda done: self._answer_with(number, done))
        else:
            self._answer(number, None, result)

    def _answer_with(self, number: int, done: Future[Any]) -> None:
        error = done.exception()
        if isinstance(error, Exception):
            self._answer(number, error, None)
        else:
            self._answer(number, None, done.result())

    def _answer(self, number: int, error: Exception | None, value: Any) -> None:
        if error is not None and not isinstance(error, CartwheelError):
            # Foreign errors may contain objects that cannot be pickled.
            error = RuntimeError(one_line(error))
        frame = _frame(_ANSWER, number, "", (error, value))
        self._post(frame, lambda: self._write(frame))

    def _end(self) -> None:
        if self._ended:
            return
        self._ended = True
        self._queue.clear()
        self.loop.forget(self._sock)
        with contextlib.suppress(OSError):
            self._sock.close()
        for future in self._waiting.values():
            _fail(future, _gone())
        self._waiting.clear()
        self._on_end()


def _frame(kind: int, number: int, name: str, content: Any) -> bytes:
    data = pickle.dumps((kind, number, name, content), protocol=pickle.HIGHEST_PROTOCOL)
    return _LENGTH.pack(len(data)) + data


def _fail(future: Future[Any], error: Exception) -> None:
    if future.set_running_or_notify_cancel():
        future.set_exception(error)


def _gone() -> ControlError:
    return ControlError("the connected process has exited", code=BRIDGE_ENDED)
