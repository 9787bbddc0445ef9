"""Frames on a stream: a JSON header and a binary payload.

A frame consists of ``CW``, the version, a zero, the two lengths as big-endian 32-bit numbers, the
header and the payload. Reading stops at anything else. Lengths are checked before any data is read,
and a started frame must be complete before a deadline.
"""

from __future__ import annotations

import contextlib
import json
import socket
import struct
import time
from dataclasses import dataclass
from typing import Any

from cartwheel.codes.command import CONTROL_LIMIT, CONTROL_MISMATCH
from cartwheel.control.faults import refusal
from cartwheel.errors import ControlError

VERSION = 1
MAX_HEADER = 4 << 20
MAX_PAYLOAD = 64 << 20
"""Bytes; enough for an image of 4000 by 4000 pixels."""
FRAME_SECONDS = 10.0
"""Timeout for receiving a started frame."""
SEND_SECONDS = 30.0
"""Timeout for sending without progress."""

PATIENCE = 30.0
"""Timeout for a request, s."""

_MAGIC = b"CW"
_START = struct.Struct(">2sBxII")
_CHUNK = 1 << 18


@dataclass(frozen=True, kw_only=True, slots=True)
class Frame:
    header: dict[str, Any]
    payload: bytes = b""


def pack(header: dict[str, Any], payload: bytes = b"") -> bytes:
    """The bytes of a frame.

    Raises:
        ControlError: The frame is too large.
    """
    text = json.dumps(header, separators=(",", ":")).encode()
    if len(text) > MAX_HEADER or len(payload) > MAX_PAYLOAD:
        raise ControlError(
            f"a {max(len(text), len(payload)) / 1e6:.0f} MB message exceeds the maximum size",
            code=CONTROL_LIMIT,
            values={"bytes": max(len(text), len(payload))},
        )
    return _START.pack(_MAGIC, VERSION, len(text), len(payload)) + text + payload


class Connection:
    """Frames over a connected socket, which it owns. Use it from one thread at a time."""

    def __init__(self, sock: socket.socket) -> None:
        self.sock = sock

    def send(self, header: dict[str, Any], payload: bytes = b"") -> None:
        """Sends a frame; blocks while the peer does not read, up to a timeout.

        Raises:
            TimeoutError: The peer received nothing for `SEND_SECONDS`.
            OSError: The connection is closed.
        """
        self.send_packed(pack(header, payload))

    def send_packed(self, data: bytes) -> None:
        """Sends the result of `pack`."""
        self.sock.settimeout(SEND_SECONDS)
        left = memoryview(data)
        while left:
            left = left[self.sock.send(left) :]

    def refuse(self, error: ControlError) -> None:
        """Sends an error if it fits into the send buffer, and closes the connection."""
        with contextlib.suppress(OSError):
            self.sock.send(pack(refusal(error)), socket.MSG_DONTWAIT)
        self.close()

    def receive(self, timeout: float | None = None) -> Frame | None:
        """The next frame; None if the peer closed the connection.

        Args:
            timeout: Seconds to wait for the first byte; None waits without limit.

        Raises:
            ControlError: The data is not a frame of this version.
            TimeoutError: No frame started within `timeout`, or a frame was not completed in time.
            OSError: The connection broke.
        """
        self.sock.settimeout(timeout)
        start = bytearray(self.sock.recv(1))
        if not start:
            return None
        deadline = time.monotonic() + FRAME_SECONDS
        start += self._read(_START.size - 1, deadline)
        magic, version, header_size, payload_size = _START.unpack(start)
        if magic != _MAGIC:
            raise ControlError(
                "the bytes received on the control socket do not follow Cartwheel's protocol",
                code=CONTROL_MISMATCH,
            )
        if version != VERSION:
            raise ControlError(
                f"the other side uses protocol version {version}, but this side uses version "
                f"{VERSION}",
                code=CONTROL_MISMATCH,
                hint="Use the same release of Cartwheel for the simulation and the command.",
                values={"version": version},
            )
        if header_size > MAX_HEADER or payload_size > MAX_PAYLOAD:
            raise ControlError("a message exceeds the maximum size", code=CONTROL_LIMIT)
        text = self._read(header_size, deadline)
        payload = self._read(payload_size, deadline)
        try:
            header = json.loads(text)
        except (ValueError, RecursionError) as error:
            raise ControlError(
                "the header of a message is not JSON", code=CONTROL_MISMATCH
            ) from error
        if not isinstance(header, dict):
            raise ControlError(
                "the header of a message is not a JSON object", code=CONTROL_MISMATCH
            )
        return Frame(header=header, payload=bytes(payload))

    def has_ended(self) -> bool:
        """Whether the peer closed the connection or sent unexpected data."""
        self.sock.settimeout(0.0)
        try:
            self.sock.recv(1, socket.MSG_PEEK)
        except BlockingIOError:
            return False
        except OSError:
            pass
        return True

    def close(self) -> None:
        """Closes the connection and wakes threads that wait on it."""
        with contextlib.suppress(OSError):  # The peer may have closed it first.
            self.sock.shutdown(socket.SHUT_RDWR)
        self.sock.close()

    def _read(self, size: int, deadline: float) -> bytearray:
        """Exactly this many bytes; memory is allocated as they arrive, not as announced."""
        data = bytearray()
        while len(data) < size:
            left = deadline - time.monotonic()
            if left <= 0:
                raise TimeoutError(f"a message was not completed within {FRAME_SECONDS:g} s")
            self.sock.settimeout(left)
            chunk = self.sock.recv(min(size - len(data), _CHUNK))
            if not chunk:
                raise ConnectionResetError(
                    "the other side closed the connection in the middle of a message"
                )
            data += chunk
        return data
