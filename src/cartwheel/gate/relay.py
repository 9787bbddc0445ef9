"""Forwards bytes between two connections in both directions until both directions end."""

from __future__ import annotations

import asyncio
import contextlib
import socket

from cartwheel.gate.frames import FrameError, Frames

CHUNK = 1 << 18
"""Buffer size in bytes per direction. A slow receiver therefore slows down the sender."""
_LINGER = 10.0
"""Time in s for which one direction may continue after the other direction has ended."""


async def relay(one: socket.socket, other: socket.socket, frames: Frames | None = None) -> None:
    """Copies until both directions have ended, or one fails.

    Args:
        one: Connection to a client.
        other: Connection to a server.
        frames: Filters the client's messages. Its errors end both directions.
    """
    pipes = [_Pipe(one, other, frames), _Pipe(other, one)]
    ends = [pipe.ended for pipe in pipes]
    try:
        done, _ = await asyncio.wait(ends, return_when=asyncio.FIRST_COMPLETED)
        if not any(end.result() for end in done):
            await asyncio.wait(ends, timeout=_LINGER)
    finally:
        for pipe in pipes:
            pipe.close()


class _Pipe:
    """One direction. It uses event loop callbacks, because a task per piece takes twice as long.

    Args:
        source: Non-blocking socket to read from.
        target: Non-blocking socket to write to.
        frames: Filters the bytes.
    """

    def __init__(
        self, source: socket.socket, target: socket.socket, frames: Frames | None = None
    ) -> None:
        self._loop = asyncio.get_running_loop()
        self._source = source
        self._target = target
        self._chunk = bytearray(CHUNK)
        self._rest = memoryview(b"")
        self._frames = frames
        self.ended: asyncio.Future[Exception | None] = self._loop.create_future()
        """The error that ended this direction, or None."""
        self._loop.add_reader(source, self._read)

    def close(self) -> None:
        """Stops copying."""
        self._loop.remove_reader(self._source)
        self._loop.remove_writer(self._target)
        self.ended.cancel()

    def _read(self) -> None:
        try:
            size = self._source.recv_into(self._chunk)
        except BlockingIOError:
            return
        except OSError as error:
            self._end(error)
            return
        if size == 0:
            self._end(None)
            return
        self._rest = memoryview(self._chunk)[:size]
        if self._frames is not None:
            try:
                self._rest = memoryview(self._frames.feed(self._rest))
            except FrameError as error:
                self._end(error)
                return
        self._write()
        if self._rest and not self.ended.done():
            self._loop.remove_reader(self._source)
            self._loop.add_writer(self._target, self._go_on)

    def _go_on(self) -> None:
        """Called when the target accepts more bytes."""
        self._write()
        if not self._rest and not self.ended.done():
            self._loop.remove_writer(self._target)
            self._loop.add_reader(self._source, self._read)

    def _write(self) -> None:
        try:
            self._rest = self._rest[self._target.send(self._rest) :]
        except BlockingIOError:
            return
        except OSError as error:
            self._end(error)

    def _end(self, error: Exception | None) -> None:
        self._loop.remove_reader(self._source)
        self._loop.remove_writer(self._target)
        if error is None:
            with contextlib.suppress(OSError):
                self._target.shutdown(socket.SHUT_WR)
        self.ended.set_result(error)
