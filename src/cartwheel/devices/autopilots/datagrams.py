"""A UDP port for programs on this computer."""

from __future__ import annotations

import contextlib
import select
import socket

from cartwheel.devices.autopilots.reports import Address
from cartwheel.forks import keep_socket

HOST = "127.0.0.1"


class DatagramPort:
    """Receives and sends datagrams. Only programs on this computer can reach it.

    Args:
        port: Number of the port.
        longest: Length of the longest valid datagram, bytes. Longer ones are cut to one byte more.

    Raises:
        OSError: The port cannot be opened.
    """

    def __init__(self, port: int, *, longest: int) -> None:
        self._most = longest + 1
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            self._socket.setblocking(False)
            self._socket.bind((HOST, port))
        except BaseException:
            self._socket.close()
            raise
        keep_socket(self._socket)

    def receive(self, seconds: float) -> tuple[bytes, Address] | None:
        """Returns the next datagram and its sender, or None if none arrives within a time in s."""
        if self._socket.fileno() < 0:
            # In a forked process.
            return None
        if seconds > 0:
            select.select([self._socket], [], [], seconds)
        try:
            return self._socket.recvfrom(self._most)
        except OSError:
            # Nothing has arrived, or a sent datagram was rejected.
            return None

    def send(self, data: bytes, address: Address) -> None:
        """Sends a datagram, which is lost without a receiver."""
        with contextlib.suppress(OSError):
            self._socket.sendto(data, address)

    def close(self) -> None:
        """Closes the port."""
        self._socket.close()
