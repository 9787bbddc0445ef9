"""The two ends of a connection between processes that answer each other at a high rate."""

from __future__ import annotations

import os
import pickle
import select
import time
from collections.abc import Mapping
from multiprocessing.connection import Connection
from typing import Any

import numpy as np

from cartwheel.geometry import Array

Packed = list[tuple[str, str, tuple[int, ...], Any]]
"""Names, types, shapes and contents of arrays."""

_SPIN = 200e-6
"""Wall time for which a process looks for data before it sleeps, s. It takes 20 to 100 µs to wake
up."""


class Link:
    """Sends and receives objects that can be pickled.

    If an exception, such as that of Ctrl-C, interrupts a transfer, the link is closed: the rest of
    the object would be received as the next one.

    Args:
        connection: Connects the two processes.
    """

    def __init__(self, connection: Connection) -> None:
        self._connection = connection
        self._arrived = select.poll()
        self._arrived.register(connection.fileno(), select.POLLIN)
        self._is_quick = False
        """Whether the last wait was short, so that the next one probably is, too."""

    def send(self, sent: Any) -> None:
        """Sends an object.

        Raises:
            OSError: The other process has ended.
        """
        # `Connection.send` also pickles sockets and such, which takes a third of its time.
        data = pickle.dumps(sent, pickle.HIGHEST_PROTOCOL)
        try:
            self._connection.send_bytes(data)
        except BaseException:
            self.close()
            raise

    def receive(self) -> Any:
        """Waits for an object.

        Raises:
            EOFError: The other process has ended, or the link is closed.
            OSError: The same.
        """
        if self._connection.closed:
            raise EOFError
        start = time.perf_counter()
        has_arrived = False
        if self._is_quick:
            while not (has_arrived := bool(self._arrived.poll(0))):
                if time.perf_counter() - start >= _SPIN:
                    break
                os.sched_yield()  # other programs come first, such as the other process
        if not has_arrived:
            self._arrived.poll()  # an interruption of this wait leaves the object where it is
        try:
            received = self._connection.recv_bytes()
        except BaseException:
            self.close()
            raise
        self._is_quick = time.perf_counter() - start < _SPIN
        return pickle.loads(received)  # noqa: S301 - sent by Cartwheel

    def close(self) -> None:
        """Closes this end."""
        self._connection.close()


def packed(arrays: Mapping[str, Array]) -> Packed:
    """Arrays in a form that is pickled in a third of the time, if they are small.

    Args:
        arrays: Contiguous arrays of numbers.
    """
    return [
        (name, each.dtype.str, each.shape, pickle.PickleBuffer(each.data))
        for name, each in arrays.items()
    ]


def unpacked(values: Packed) -> dict[str, Array]:
    """The arrays of `packed` in the other process."""
    return {name: np.ndarray(shape, kind, buffer) for name, kind, shape, buffer in values}
