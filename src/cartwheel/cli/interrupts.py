"""Ctrl-C and SIGTERM end a command at once, whatever it does, and leave no traceback.

The first signal asks: a running simulation stops, anything else is left by an exception.
Where it is not heard, as inside a compiler of meshes, where the end takes too long, or where a
second signal comes, the process ends there and then.
"""

from __future__ import annotations

import contextlib
import os
import signal
import socket
import sys
import threading
from collections.abc import Callable, Iterator
from types import FrameType

PATIENCE = 0.35
"""s that the first signal may take to be heard."""

FOR_THE_END = 2.0
"""s that the end may take once the signal was heard; a busy machine needs some."""


class Interrupted(BaseException):
    """A signal asked for the end; no `Exception`, so that nobody takes it for a failure."""

    def __init__(self, number: int) -> None:
        self.number = number
        super().__init__(f"signal {number}")


class _State:
    """What the handler knows."""

    def __init__(self) -> None:
        self.count = 0
        self.number = int(signal.SIGINT)
        self.status = 128 + signal.SIGINT
        self.handler: Callable[[], None] | None = None
        self.last_rites: list[Callable[[], None]] = []


_state = _State()


def install() -> None:
    """Takes over both signals; once, on the main thread."""
    # A byte is written here by the signal itself, also while the interpreter is inside a
    # long call and cannot run its handler.
    reader, writer = socket.socketpair()
    writer.setblocking(False)
    signal.set_wakeup_fd(writer.fileno(), warn_on_full_buffer=False)
    threading.Thread(target=_watch, args=(reader, writer), name="signals", daemon=True).start()
    signal.signal(signal.SIGINT, _on_signal)
    signal.signal(signal.SIGTERM, _on_signal)
    sys.unraisablehook = _on_unraisable


@contextlib.contextmanager
def handled_by(handler: Callable[[], None], *, status: int | None = None) -> Iterator[None]:
    """Calls `handler` at a signal instead of raising `Interrupted`.

    Args:
        handler: Must make the enclosed code return soon.
        status: Of the process when it has to be ended; the signal's own when None.
    """
    _state.handler = handler
    before, _state.status = _state.status, _state.status if status is None else status
    try:
        yield
    finally:
        _state.handler, _state.status = None, before


@contextlib.contextmanager
def finally_do(rite: Callable[[], None]) -> Iterator[None]:
    """Calls `rite` at the end of the enclosed code, also where the process is ended within."""
    _state.last_rites.append(rite)
    try:
        yield
    finally:
        if rite in _state.last_rites:
            _state.last_rites.remove(rite)
            rite()


def came() -> bool:
    """Whether a signal has come and was not the end that a command waits for."""
    return _state.count > 0


def last_signal() -> int:
    """The number of the last signal that came."""
    return _state.number


def leave(status: int, *, patience: float | None = None) -> None:
    """Ends the process now: no thread and no library has a say, or a word, any more.

    Args:
        status: Of the process.
        patience: s that whoever reads our output has for the rest of it; None waits for it.
    """
    for rite in reversed(_state.last_rites):
        with contextlib.suppress(Exception):
            rite()
    flushing = threading.Thread(target=_flush, daemon=True)
    flushing.start()
    flushing.join(patience)
    os._exit(status)


def _flush() -> None:
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(Exception):
            stream.flush()


def _on_signal(number: int, _: FrameType | None) -> None:
    _state.count += 1
    _state.number = number
    if _state.handler is not None:
        _state.handler()
    elif _state.count == 1:
        _state.status = 128 + number
        raise Interrupted(number)


def _on_unraisable(unraisable: sys.UnraisableHookArgs) -> None:
    """Ends the process where the interpreter would report `Interrupted` and go on without it.

    It does so in callbacks of its own, those of weak references for one, as while importing.
    """
    if isinstance(unraisable.exc_value, Interrupted):
        leave(128 + unraisable.exc_value.number, patience=PATIENCE)
    sys.__unraisablehook__(unraisable)


def _watch(reader: socket.socket, _writer: socket.socket) -> None:
    """Ends the process where the first signal did not do so in time, or at a second one."""
    _await_signal(reader)
    for patience in (PATIENCE, FOR_THE_END):
        reader.settimeout(patience)
        try:
            _await_signal(reader)
            break
        except TimeoutError:
            if not _state.count:
                break
    leave(_state.status, patience=0.05)


def _await_signal(reader: socket.socket) -> None:
    """The next of both; each signal that has a handler writes its number."""
    while reader.recv(1)[0] not in (signal.SIGINT, signal.SIGTERM):
        pass
