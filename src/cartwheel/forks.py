"""Sockets and objects that stay with the parent process after a fork.

A forked process inherits all file descriptors, but no threads. While it holds a copy of a socket,
the other end does not notice that the parent has exited.
"""

from __future__ import annotations

import contextlib
import os
import socket
import weakref
from pathlib import Path
from typing import Protocol


class Parental(Protocol):
    """An object whose work stays with the parent process."""

    def leave_to_parent(self) -> None:
        """Called in the forked process. Must not acquire locks that existed before the fork."""


_sockets: weakref.WeakSet[socket.socket] = weakref.WeakSet()
_objects: weakref.WeakSet[Parental] = weakref.WeakSet()


def keep_socket(sock: socket.socket) -> None:
    """Closes the socket in forked processes, without a shutdown of the connection."""
    _sockets.add(sock)


def keep_object(owner: Parental) -> None:
    """Calls the object's `leave_to_parent` in forked processes."""
    _objects.add(owner)


class AddressSockets:
    """Keeps all sockets of a server out of forked processes, if a library opens them.

    Args:
        address: Address of the server, which no other server uses.
    """

    def __init__(self, address: tuple[str, int]) -> None:
        self._address = address
        keep_object(self)

    def leave_to_parent(self) -> None:
        """Replaces the sockets at both ends by the null device.

        The library's objects close the file descriptors at some time, so their numbers must not
        become free for other files.
        """
        null = os.open(os.devnull, os.O_RDWR)
        for file in Path("/dev/fd").iterdir():
            with contextlib.suppress(OSError):  # Not a socket, or the descriptor of this listing.
                if self._uses(int(file.name)):
                    os.dup2(null, int(file.name), inheritable=False)
        os.close(null)

    def _uses(self, descriptor: int) -> bool:
        sock = socket.socket(fileno=descriptor)
        try:
            return self._address in (sock.getsockname(), _peer(sock))
        finally:
            sock.detach()


def _peer(sock: socket.socket) -> object:
    """Address of the other end; None for a listening socket."""
    try:
        return sock.getpeername()
    except OSError:
        return None


def _after_fork() -> None:
    for sock in list(_sockets):
        number = sock.detach()
        if number >= 0:
            os.close(number)
    _sockets.clear()
    for owner in list(_objects):
        owner.leave_to_parent()
    _objects.clear()


os.register_at_fork(after_in_child=_after_fork)
