"""Ctrl-C and SIGTERM end any command immediately and without a traceback.

The first signal requests the end: a running simulation stops, anything else is left by an
exception. The process is terminated if it does not respond, as inside a mesh compiler, if the
shutdown takes too long, or after a second signal.
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
"""Maximum time to respond to the first signal, s."""

FOR_THE_END = 2.0
"""Maximum shutdown time after the response, s; a busy machine needs some."""


class Interrupted(BaseException):
    """A signal requested the end; not an `Exception`, so that it is not handled as a failure."""

    def __init__(self, number: int) -> None:
        self.number = number
        super().__init__(number)

    def __str__(self) -> str:
        return f"signal {self.number}"


class _State:
    """State of the signal handler."""

    def __init__(self) -> None:
        self.count = 0
        self.number = int(signal.SIGINT)
        self.status = 128 + signal.SIGINT
        self.handler: Callable[[], None] | None = None
        self.last_rites: list[Callable[[], None]] = []


_state = _State()


def install() -> None:
    """Installs the handlers for both signals; call it once, on the main thread."""
    # The signal itself writes a byte here, even while the interpreter is in a long call and cannot
    # run its handler.
    reader, writer = socket.socketpair()
    writer.setblocking(False)
    signal.set_wakeup_fd(writer.fileno(), warn_on_full_buffer=False)
    threading.Thread(target=_watch, args=(reader, writer), name="signals", daemon=True).start()
    signal.signal(signal.SIGINT, _on_signal)
    signal.signal(signal.SIGTERM, _on_signal)
    sys.unraisablehook = _on_unraisable


@contextlib.contextmanager
def handled_by(handler: Callable[[], None], *, status: int | None = None) -> Iterator[None]:
    """Calls `handler` for a signal instead of raising `Interrupted`.

    Args:
        handler: Must make the enclosed code return soon.
        status: Exit status if the process must be terminated; None for the signal's status.
    """
    _state.handler = handler
    before, _state.status = _state.status, _state.status if status is None else status
    try:
        yield
    finally:
        _state.handler, _state.status = None, before


@contextlib.contextmanager
def finally_do(rite: Callable[[], None]) -> Iterator[None]:
    """Calls `rite` at the end of the enclosed code, even if the process is terminated there."""
    _state.last_rites.append(rite)
    try:
        yield
    finally:
        if rite in _state.last_rites:
            _state.last_rites.remove(rite)
            rite()


def came() -> bool:
    """Whether a signal was received that is not the normal end of a command."""
    return _state.count > 0


def last_signal() -> int:
    """The number of the last signal."""
    return _state.number


def leave(status: int, *, patience: float | None = None) -> None:
    """Ends the process immediately: no thread or library can delay it or print anything.

    Args:
        status: Exit status.
        patience: Maximum time for readers of the output, s; None waits without limit.
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
    """Ends the process where the interpreter would only print `Interrupted` and continue.

    This happens in callbacks, for example of weak references during imports.
    """
    if isinstance(unraisable.exc_value, Interrupted):
        leave(128 + unraisable.exc_value.number, patience=PATIENCE)
    sys.__unraisablehook__(unraisable)


def _watch(reader: socket.socket, _writer: socket.socket) -> None:
    """Ends the process if the first signal is not handled in time, or at a second signal."""
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
    """Waits for either signal; each signal with a handler writes its number."""
    while reader.recv(1)[0] not in (signal.SIGINT, signal.SIGTERM):
        pass
