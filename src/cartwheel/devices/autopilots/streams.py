"""A TCP port for one program on this computer."""

from __future__ import annotations

import contextlib
import select
import socket

from cartwheel.devices.autopilots.datagrams import HOST
from cartwheel.devices.autopilots.reports import Address
from cartwheel.forks import keep_socket

_MOST = 4096
"""Bytes that are read at once."""


class StreamPort:
    """Accepts one connection at a time. Only programs on this computer can reach it.

    Args:
        port: Number of the port.

    Raises:
        OSError: The port cannot be opened.
    """

    def __init__(self, port: int) -> None:
        self._stream: socket.socket | None = None
        self.peer: Address | None = None
        """Address of the connected program; None: no program is connected."""
        self._server = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
        try:
            self._server.setblocking(False)
            # A port whose last connection has just ended can be opened again.
            self._server.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            self._server.bind((HOST, port))
            self._server.listen(1)
        except BaseException:
            self._server.close()
            raise
        keep_socket(self._server)

    def accept(self) -> tuple[socket.socket, Address] | None:
        """Returns the next program that has connected, without waiting; None: there is none."""
        if self._server.fileno() < 0:
            # In a forked process.
            return None
        try:
            stream, address = self._server.accept()
        except OSError:
            return None
        return stream, address

    def connect(self, stream: socket.socket, address: Address) -> None:
        """Makes an accepted program the connected one; the previous connection is closed."""
        self.drop()
        stream.setblocking(False)
        stream.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        keep_socket(stream)
        self._stream, self.peer = stream, address

    def receive(self, seconds: float) -> bytes | None:
        """Returns the next bytes, or None if none arrive within a time in s.

        If the program has closed the connection, `peer` is None afterwards.
        """
        stream = self._stream
        if stream is None or stream.fileno() < 0:
            return None
        if seconds > 0:
            select.select([stream], [], [], seconds)
        try:
            data = stream.recv(_MOST)
        except BlockingIOError:
            return None
        except OSError:
            data = b""
        if not data:
            self.drop()
            return None
        return data

    def send(self, data: bytes) -> None:
        """Sends bytes. If the program does not receive them, the connection is closed."""
        if self._stream is None:
            return
        try:
            complete = self._stream.send(data) == len(data)
        except OSError:
            complete = False
        if not complete:
            # The rest of a message cannot be sent later without waiting.
            self.drop()

    def drop(self) -> None:
        """Closes the connection."""
        stream, self._stream, self.peer = self._stream, None, None
        if stream is not None:
            with contextlib.suppress(OSError):
                stream.close()

    def close(self) -> None:
        """Closes the connection and the port."""
        self.drop()
        self._server.close()
