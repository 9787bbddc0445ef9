"""Sockets and objects that stay with the parent process after a fork.

A forked process inherits all file descriptors, but no threads. While it holds a copy of a socket,
the other end does not notice that the parent has exited.
"""

from __future__ import annotations

import os
import socket
import weakref
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
