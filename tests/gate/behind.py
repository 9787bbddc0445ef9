"""A server as it may stand behind a gate, and clients without manners."""

from __future__ import annotations

import base64
import hashlib
import socket
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from cartwheel.gate.access import Access
from cartwheel.gate.gate import Gate
from cartwheel.gate.listening import hidden_host, listen
from cartwheel.options import PORT

PATIENCE = 60.0
PAGE = b"<html>page</html>"
_GUID = b"258EAFA5-E914-47DA-95CA-C5AB0DC85B11"
KEY = base64.b64encode(b"0123456789abcdef")


class Behind:
    """Answers each request, keeps what it was sent; echoes behind a websocket's handshake."""

    def __init__(self, *, agrees: bool = True) -> None:
        self.host = hidden_host()
        self._agrees = agrees
        self._listener = socket.create_server((self.host, 0))
        self.address: tuple[str, int] = self._listener.getsockname()
        self.heard: list[bytearray] = []
        """What came, for each connection."""
        threading.Thread(target=self._accept, daemon=True).start()

    def _accept(self) -> None:
        while True:
            try:
                sock, _ = self._listener.accept()
            except OSError:
                return
            self.heard.append(bytearray())
            threading.Thread(target=self._serve, args=(sock, self.heard[-1]), daemon=True).start()

    def _serve(self, sock: socket.socket, heard: bytearray) -> None:
        with sock:
            while b"\r\n\r\n" not in heard:
                data = sock.recv(65536)
                if not data:
                    return
                heard += data
            if b"upgrade: websocket" in heard.lower() and self._agrees:
                key = next(
                    line.partition(b":")[2].strip()
                    for line in bytes(heard).split(b"\r\n")
                    if line.lower().startswith(b"sec-websocket-key")
                )
                accept = base64.b64encode(hashlib.sha1(key + _GUID).digest())
                sock.sendall(
                    b"HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\n"
                    b"Connection: Upgrade\r\nSec-WebSocket-Accept: " + accept + b"\r\n\r\n"
                )
                while data := sock.recv(65536):
                    heard += data
                    sock.sendall(data)
            else:
                sock.sendall(
                    b"HTTP/1.1 200 OK\r\nContent-Type: text/html\r\nSet-Cookie: own=1\r\n"
                    b"Content-Length: %d\r\n\r\n%s" % (len(PAGE), PAGE)
                )
                # It would go on to serve whatever came next.
                while data := sock.recv(65536):
                    heard += data

    def close(self) -> None:
        self._listener.close()


class Gated:
    """A gate with a server behind it."""

    def __init__(self, access: Access, **options: Any) -> None:
        agrees = options.pop("agrees", True)
        self.access = access
        self.behind = Behind(agrees=agrees)
        listener = listen(access.host, 0, title="a test", option=PORT)
        self.port: int = listener.getsockname()[1]
        self.refused: list[str] = []
        options.setdefault("refused", self.refused.append)
        self.gate = Gate(listener, access, self.behind.address, **options)
        self.gate.start()

    def connect(self) -> socket.socket:
        return socket.create_connection(("127.0.0.1", self.port), timeout=PATIENCE)

    def ask(self, request: bytes) -> bytes:
        """Everything that comes back for some bytes, until the connection ends."""
        with self.connect() as sock:
            sock.sendall(request)
            return rest(sock)

    def get(self, *headers: str, target: str = "/", host: str | None = None) -> bytes:
        return self.ask(self.head(*headers, target=target, host=host))

    def head(self, *headers: str, target: str = "/", host: str | None = None) -> bytes:
        lines = [f"GET {target} HTTP/1.1", f"Host: {host or f'localhost:{self.port}'}", *headers]
        return "\r\n".join([*lines, "", ""]).encode("latin-1")

    def handshake(self, *headers: str, **options: Any) -> bytes:
        """Of a websocket."""
        own = ("Upgrade: websocket", "Connection: Upgrade", "Sec-WebSocket-Version: 13",
               f"Sec-WebSocket-Key: {KEY.decode()}")  # fmt: skip
        return self.head(*own, *headers, **options)

    def close(self) -> None:
        self.gate.close()
        self.behind.close()


@contextmanager
def gated(access: Access | None = None, **options: Any) -> Iterator[Gated]:
    made = Gated(access or Access.of("127.0.0.1"), **options)
    try:
        yield made
    finally:
        made.close()


def rest(sock: socket.socket) -> bytes:
    """What comes until the end; of a connection that is reset, until then."""
    found = bytearray()
    while True:
        try:
            data = sock.recv(65536)
        except ConnectionResetError:
            return bytes(found)
        if not data:
            return bytes(found)
        found += data


def status(answer: bytes) -> int:
    return int(answer.split(b" ", 2)[1])


def eventually(condition: Callable[[], Any], what: str) -> Any:
    deadline = time.monotonic() + PATIENCE
    while not (found := condition()):
        assert time.monotonic() < deadline, f"{what} did not come within {PATIENCE} s"
        time.sleep(0.01)
    return found
