"""HTTP server for XML-RPC on the event loop. Requests may be malformed.

Python's ``xmlrpc.server`` is not used because it starts a thread for each connection, without
limits.
"""

from __future__ import annotations

import contextlib
import socket
import time
import xmlrpc.client
from collections.abc import Callable
from typing import Any

from cartwheel.bridges.loop import READ, WRITE, Loop, taken
from cartwheel.bridges.ros1.marshalling import read_values

HEAD_LIMIT = 16 << 10
BODY_LIMIT = 256 << 10
"""Maximum size in bytes. A thousand publishers of a topic occupy a hundred thousand."""
BUSY = 10.0
"""Timeout in s for completing a request that has begun, and for receiving a response."""
IDLE = 60.0
"""Time in s after which an idle connection is closed. Clients reconnect when necessary."""
_REASON = 500
"""Maximum length of a fault in characters."""

Handler = Callable[[str, tuple[Any, ...]], Any]


class RpcConnection:
    """A client of the node's XML-RPC interface. Used on the loop's thread.

    Requests are handled one by one. Nothing is read while a request or response is pending, so a
    client that does not read its responses blocks only itself.

    Args:
        loop: Event loop of the connection.
        sock: Connected socket.
        handle: Handles a method with its arguments. Its exceptions are returned as faults.
        on_close: Called once at the end.
    """

    def __init__(
        self,
        loop: Loop,
        sock: socket.socket,
        handle: Handler,
        on_close: Callable[[RpcConnection], None],
    ) -> None:
        self._loop = loop
        self._sock = sock
        self._handle = handle
        self._on_close = on_close
        self._received = bytearray()
        self._unsent = memoryview(b"")
        self._closing = False
        self._since = time.monotonic()
        """Start time of the current request, response or idle period."""
        self.closed = False
        sock.setblocking(False)
        with contextlib.suppress(OSError):
            sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        loop.watch(sock, READ, self._ready)

    def overdue(self, now: float) -> bool:
        """Whether the client exceeds a timeout."""
        busy = self._received or self._unsent
        return now - self._since > (BUSY if busy else IDLE)

    def close(self) -> None:
        """Closes the connection."""
        if not self.closed:
            self.closed = True
            self._loop.forget(self._sock)
            self._sock.close()
            self._on_close(self)

    def _ready(self, events: int) -> None:
        if self.closed:
            return
        if events & WRITE:
            self._flush()
        elif events & READ:
            self._read()
        self._go_on()

    def _read(self) -> None:
        data = taken(self._sock, 1 << 16)
        if data is None:
            return
        if not data:
            self.close()
            return
        if not self._received:
            self._since = time.monotonic()
        self._received += data

    def _go_on(self) -> None:
        """Handles the next request. Later requests wait until other connections had a turn."""
        if self.closed:
            return
        if not self._unsent and not self._closing and self._take_request():
            self._since = time.monotonic()
        if self.closed:
            return
        if self._unsent:
            self._loop.watch(self._sock, WRITE, self._ready)
        elif self._closing:
            self.close()
        elif self._extent() is not None:  # a complete or invalid request is available
            self._loop.forget(self._sock)
            self._loop.post(self._go_on)
        else:
            self._loop.watch(self._sock, READ, self._ready)

    def _extent(self) -> tuple[int, int, str] | None:
        """End of the first header and of its body, or an error status; None if data is missing."""
        end = self._received.find(b"\r\n\r\n", 0, HEAD_LIMIT)
        if end < 0:
            if len(self._received) < HEAD_LIMIT:
                return None
            return 0, 0, "431 Request Header Fields Too Large"
        lines, fields = _head(self._received[:end])
        length = fields.get("content-length", "")
        if not lines[0].startswith("POST ") or not (length.isascii() and length.isdecimal()):
            return 0, 0, "400 Bad Request"
        if "origin" in fields:
            # Browsers send this header for web pages. ROS nodes do not.
            return 0, 0, "403 Forbidden"
        if len(length) > 9 or int(length) > BODY_LIMIT:
            return 0, 0, "413 Payload Too Large"
        whole = end + 4 + int(length)
        return None if len(self._received) < whole else (end, whole, "")

    def _take_request(self) -> bool:
        """Handles the first request. Returns whether there was a request."""
        extent = self._extent()
        if extent is None:
            return False
        end, whole, refusal = extent
        if refusal:
            self._received.clear()
            self._answer(refusal, b"", keep=False)
            return True
        lines, fields = _head(self._received[:end])
        body = bytes(self._received[end + 4 : whole])
        del self._received[:whole]
        wish = fields.get("connection", "").lower()
        keep = wish == "keep-alive" or (wish != "close" and "HTTP/1.1" in lines[0])
        self._answer("200 OK", self._respond(body), keep=keep)
        return True

    def _respond(self, body: bytes) -> bytes:
        try:
            arguments, method = read_values(body)
            answer = xmlrpc.client.dumps(
                (self._handle(str(method), arguments),), methodresponse=True, allow_none=False
            )
        except Exception as error:  # noqa: BLE001 - the client receives any error
            reason = f"{type(error).__name__}: {error}"[:_REASON]
            answer = xmlrpc.client.dumps(xmlrpc.client.Fault(1, reason), methodresponse=True)
        return answer.encode(errors="replace")

    def _answer(self, status: str, body: bytes, *, keep: bool) -> None:
        head = (
            f"HTTP/1.1 {status}\r\nContent-Type: text/xml\r\nContent-Length: {len(body)}\r\n"
            f"Connection: {'keep-alive' if keep else 'close'}\r\n\r\n"
        )
        self._unsent = memoryview(head.encode() + body)
        self._closing = not keep
        self._flush()

    def _flush(self) -> None:
        try:
            count = self._sock.send(self._unsent)
        except BlockingIOError:
            return
        except OSError:
            self.close()
            return
        self._unsent = self._unsent[count:]
        if not self._unsent:
            self._since = time.monotonic()


def _head(data: bytes | bytearray) -> tuple[list[str], dict[str, str]]:
    """Request line and headers, whose names are in lower case."""
    lines = data.decode("latin-1").split("\r\n")
    pairs = (line.partition(":") for line in lines[1:])
    return lines, {name.strip().lower(): value.strip() for name, _, value in pairs}
