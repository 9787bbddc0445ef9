"""The server side of XML-RPC on the loop: short requests, any of which may be nonsense."""

from __future__ import annotations

import contextlib
import socket
import xmlrpc.client
from collections.abc import Callable
from typing import Any

from cartwheel.bridges.loop import READ, WRITE, Loop, taken

HEAD_LIMIT = 16 << 10
BODY_LIMIT = 1 << 20
"""Bytes; a list of publishers takes a few thousand."""
IDLE = 60.0
"""s after which a silent connection is closed; whoever calls again opens another."""

Handler = Callable[[str, tuple[Any, ...]], Any]


class RpcConnection:
    """One client of our XML-RPC interface; on the loop's thread.

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
        self._unsent = b""
        self._closing = False
        self._turns = 0
        self._looked_at = 0
        self.closed = False
        sock.setblocking(False)
        with contextlib.suppress(OSError):
            sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        loop.watch(sock, READ, self._ready)
        loop.after(IDLE, self._look)

    def close(self) -> None:
        """Ends the connection."""
        if not self.closed:
            self.closed = True
            self._loop.forget(self._sock)
            self._sock.close()
            self._on_close(self)

    def _look(self) -> None:
        """Closes a connection that has asked nothing since the last look."""
        if self.closed:
            return
        if self._turns == self._looked_at:
            self.close()
            return
        self._looked_at = self._turns
        self._loop.after(IDLE, self._look)

    def _ready(self, events: int) -> None:
        if events & WRITE:
            self._flush()
        if events & READ and not self.closed:
            self._read()

    def _read(self) -> None:
        data = taken(self._sock, 1 << 16)
        if data is None:
            return
        if not data:
            self.close()
        elif not self._closing:
            self._received += data
            while not self.closed and not self._closing and self._take_request():
                pass

    def _take_request(self) -> bool:
        """Answers the first request that is there in full; whether there was one."""
        end = self._received.find(b"\r\n\r\n")
        if end < 0 or end > HEAD_LIMIT:
            if len(self._received) > HEAD_LIMIT:
                self.close()
            return False
        lines = self._received[:end].decode("latin-1").split("\r\n")
        fields = {
            name.strip().lower(): value.strip()
            for name, _, value in (line.partition(":") for line in lines[1:])
        }
        length = fields.get("content-length", "")
        if not lines[0].startswith("POST ") or not length.isdecimal() or len(length) > 9:
            self._answer("400 Bad Request", b"", keep=False)
            return False
        start = end + 4
        if int(length) > BODY_LIMIT:
            self._answer("413 Payload Too Large", b"", keep=False)
            return False
        if len(self._received) < start + int(length):
            return False
        body = bytes(self._received[start : start + int(length)])
        del self._received[: start + int(length)]
        self._turns += 1
        wish = fields.get("connection", "").lower()
        keep = wish == "keep-alive" or (wish != "close" and "HTTP/1.1" in lines[0])
        self._answer("200 OK", self._respond(body), keep=keep)
        return True

    def _respond(self, body: bytes) -> bytes:
        try:
            arguments, method = xmlrpc.client.loads(body)
            answer = xmlrpc.client.dumps(
                (self._handle(str(method), arguments),), methodresponse=True, allow_none=False
            )
        except Exception as error:  # noqa: BLE001 - the caller is told, whatever it was
            fault = xmlrpc.client.Fault(1, f"{type(error).__name__}: {error}")
            answer = xmlrpc.client.dumps(fault, methodresponse=True)
        return answer.encode(errors="replace")

    def _answer(self, status: str, body: bytes, *, keep: bool) -> None:
        head = (
            f"HTTP/1.1 {status}\r\nContent-Type: text/xml\r\nContent-Length: {len(body)}\r\n"
            f"Connection: {'keep-alive' if keep else 'close'}\r\n\r\n"
        )
        self._unsent += head.encode() + body
        self._closing = not keep
        self._flush()

    def _flush(self) -> None:
        try:
            count = self._sock.send(self._unsent)
        except BlockingIOError:
            count = 0
        except OSError:
            self.close()
            return
        self._unsent = self._unsent[count:]
        if self._unsent:
            self._loop.watch(self._sock, READ | WRITE, self._ready)
        elif self._closing:
            self.close()
        else:
            self._loop.watch(self._sock, READ, self._ready)
