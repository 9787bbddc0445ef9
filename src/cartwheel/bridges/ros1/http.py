"""The server side of XML-RPC on the loop: short requests, any of which may be nonsense."""

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
"""Bytes; a thousand publishers of a topic take a hundred thousand."""
BUSY = 10.0
"""s that a caller may take to complete a request that it has begun, or to read an answer."""
IDLE = 60.0
"""s after which a silent connection is closed; whoever calls again opens another."""
_REASON = 500
"""Characters of a fault."""

Handler = Callable[[str, tuple[Any, ...]], Any]


class RpcConnection:
    """One client of our XML-RPC interface; on the loop's thread.

    It does one request at a time. Nothing is read while a request waits to be done or an answer
    to be sent, so that a client that does not read its answers holds up itself alone.

    Args:
        loop: Watches it.
        sock: Connected.
        handle: Answers a method with its arguments; what it raises becomes a fault.
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
        """When the present request, answer or silence has begun."""
        self.closed = False
        sock.setblocking(False)
        with contextlib.suppress(OSError):
            sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        loop.watch(sock, READ, self._ready)

    def overdue(self, now: float) -> bool:
        """Whether the client has taken too long with what it does."""
        busy = self._received or self._unsent
        return now - self._since > (BUSY if busy else IDLE)

    def close(self) -> None:
        """Ends the connection."""
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
        """Does the next request; those that follow wait until everybody else had a turn."""
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
        elif self._is_complete():
            self._loop.forget(self._sock)
            self._loop.post(self._go_on)
        else:
            self._loop.watch(self._sock, READ, self._ready)

    def _is_complete(self) -> bool:
        """Whether something is there that can be answered, if only by a refusal."""
        return self._extent() is not None

    def _extent(self) -> tuple[int, int, str] | None:
        """Where the first head and its body end, or a refusal; None where more has to come."""
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
            # A browser's, on behalf of some page: no node of ROS has an origin.
            return 0, 0, "403 Forbidden"
        if len(length) > 9 or int(length) > BODY_LIMIT:
            return 0, 0, "413 Payload Too Large"
        whole = end + 4 + int(length)
        return None if len(self._received) < whole else (end, whole, "")

    def _take_request(self) -> bool:
        """Answers the first request; whether there was one."""
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
        except Exception as error:  # noqa: BLE001 - the caller is told, whatever it was
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
    """The lines of a head, and its fields by their names in small letters."""
    lines = data.decode("latin-1").split("\r\n")
    pairs = (line.partition(":") for line in lines[1:])
    return lines, {name.strip().lower(): value.strip() for name, _, value in pairs}
