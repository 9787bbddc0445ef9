"""A reverse proxy that checks each request before it forwards bytes to the server.

It uses callbacks of asyncio's loop, which is the fastest of the compared variants
(``benchmarks/README.md``). The web viewer's gate runs on viser's own loop, so no additional thread
takes Python's lock from the simulation.
"""

from __future__ import annotations

import asyncio
import contextlib
import socket
import threading
from collections.abc import Callable
from concurrent.futures import Future
from http import HTTPStatus
from typing import Protocol

import h11

from cartwheel.forks import keep_socket
from cartwheel.gate.access import Access, Refusal
from cartwheel.gate.frames import FrameError, Frames, Room
from cartwheel.gate.relay import relay
from cartwheel.gate.request import HEAD_SIZE, Request, RequestError, next_event, read_request
from cartwheel.reporting import Once

MOST_WAITING = 128
"""Maximum number of connections whose request is incomplete. A new one replaces the oldest."""
MOST_ADMITTED = 64
"""Maximum number of connections to the server behind."""
_HEAD_SECONDS = 10.0
"""Timeout for the request's header, for connecting to the server, and for the response's
header."""
_STALL_SECONDS = 60.0
"""Timeout for a client to receive a piece of a response."""
_FAREWELL_SECONDS = 1.0
"""Time for which a refused client may still send. Without it, it may never see the response."""
_END_SECONDS = 2.0
"""Timeout for closing all connections."""
_ACCEPT_PAUSE = 0.1
"""Pause in s after a connection could not be accepted."""
_INNER_BUFFER = 1 << 18
"""Receive buffer in bytes for the server's messages. Messages that the client does not
receive must wait in the server, which drops old messages."""
_SHOWN = 20
_SHOWN_LENGTH = 100
_WEBSOCKET = (b"upgrade", b"connection", b"sec-websocket")
_CONTENT = (b"content-type", b"content-length", b"content-encoding")
"""Response headers that are passed to clients."""
_ENTRANCE = (
    b'<!doctype html><meta charset="utf-8"><meta http-equiv="refresh" content="0;url=/">'
    b'<title>Cartwheel</title><a href="/">Continue</a>'
)
"""Leads to the address without the token. A redirect does not work: a browser that followed a
link from a different site would not send the cookie with the redirected request."""
_KEEP_ALIVE = {"TCP_KEEPIDLE": 60, "TCP_KEEPINTVL": 20, "TCP_KEEPCNT": 3}
"""Idle time in s, interval in s, and number of probes until a vanished peer is disconnected."""

Refused = Callable[[str], None]


class Client(Protocol):
    """A connected client of a server."""

    def passes(self, text: bytes) -> bool:
        """Whether to forward a text message of the client. Called on the gate's thread."""

    def broke(self, fault: str) -> None:
        """Called on the gate's thread when the client is disconnected because of its messages."""

    def end(self) -> None:
        """Called on the gate's thread when the client has disconnected."""


class Gate:
    """Forwards requests that `access` allows to the server behind.

    A connection carries one request. The gate reads it completely, and writes a new request for
    the server. After a websocket handshake, bytes are forwarded unchanged, except for text
    messages that `client` rejects.

    Args:
        listener: Listening socket, which the gate owns from now on.
        access: Access rules.
        server: Address of the server behind.
        apps: Origins of programs that may connect, in addition to the server's own pages.
        refused: Called on the gate's thread with each refused origin.
        client: Creates the object that checks a new client's text messages. None allows all.
    """

    def __init__(
        self,
        listener: socket.socket,
        access: Access,
        server: tuple[str, int],
        *,
        apps: tuple[str, ...] = (),
        refused: Refused = lambda _: None,
        client: Callable[[], Client] | None = None,
    ) -> None:
        self._listener = listener
        keep_socket(listener)
        self._access = access
        self._server = server
        self._apps = apps
        self._refused = refused
        self._client = client
        self._room = Room()
        self._once = Once(_SHOWN)
        self._cookie = f"cartwheel-{listener.getsockname()[1]}"
        self._waiting: dict[asyncio.Task[None], None] = {}
        self._admitted = 0
        self._peers: dict[int, tuple[str, str]] = {}
        self._own_loop: asyncio.AbstractEventLoop | None = None
        self._serving: Future[None] | None = None
        self._ended = threading.Event()

    def peer(self, port: int) -> str | None:
        """Address of the client whose connection reaches the server from this port."""
        return self._peers[port][0] if port in self._peers else None

    def cookie(self, port: int, name: str) -> str:
        """Cookie of the client on this port; empty if absent. The content is not validated."""
        _, cookies = self._peers.get(port, ("", ""))
        pairs = (pair.strip().partition("=") for pair in cookies.split(";"))
        return next((value for found, _, value in pairs if found == name), "")

    def start(self, loop: asyncio.AbstractEventLoop | None = None) -> None:
        """Starts to accept connections.

        Args:
            loop: Running event loop to use. None creates a loop in a separate thread.
        """
        if loop is None:
            loop = self._own_loop = asyncio.new_event_loop()
            threading.Thread(target=loop.run_forever, name="gate", daemon=True).start()
        self._serving = asyncio.run_coroutine_threadsafe(self._serve(), loop)

    def close(self) -> None:
        """Closes all connections. Callable on any thread except the event loop's."""
        if self._serving is None:
            self._listener.close()
            return
        self._serving.cancel()
        self._ended.wait(_END_SECONDS)
        if self._own_loop is not None:
            self._own_loop.call_soon_threadsafe(self._own_loop.stop)

    # -- on the event loop's thread

    async def _serve(self) -> None:
        loop = asyncio.get_running_loop()
        tasks: set[asyncio.Task[None]] = set()
        try:
            while True:
                try:
                    sock, address = await loop.sock_accept(self._listener)
                except OSError:
                    # No file descriptor is free, or the client has already disconnected.
                    await asyncio.sleep(_ACCEPT_PAUSE)
                    continue
                keep_socket(sock)
                task = loop.create_task(self._handle(sock, address))
                tasks.add(task)
                self._waiting[task] = None
                task.add_done_callback(lambda task, sock=sock: self._forget(task, sock, tasks))  # type: ignore[misc]
                if len(self._waiting) > MOST_WAITING:
                    next(iter(self._waiting)).cancel()
        finally:
            self._listener.close()
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)
            self._ended.set()

    def _forget(
        self, task: asyncio.Task[None], sock: socket.socket, tasks: set[asyncio.Task[None]]
    ) -> None:
        """Closes the socket, even if the task was cancelled before it started."""
        sock.close()
        tasks.discard(task)
        self._waiting.pop(task, None)

    async def _handle(self, sock: socket.socket, address: tuple[str, int]) -> None:
        with contextlib.suppress(OSError, EOFError, TimeoutError, h11.ProtocolError):
            _prepare(sock)
            try:
                async with asyncio.timeout(_HEAD_SECONDS):
                    request = await read_request(sock)
            except RequestError as error:
                await _refuse(sock, Refusal(status=error.status, text=str(error)))
                return
            refusal = self._refusal(request)
            if refusal is not None:
                await _refuse(sock, refusal)
                return
            self._waiting.pop(asyncio.current_task(), None)  # type: ignore[arg-type]
            self._admitted += 1
            try:
                await self._admit(sock, address, request)
            finally:
                self._admitted -= 1

    def _refusal(self, request: Request) -> Refusal | None:
        found = self._access.refusal(request.asked, apps=self._apps, cookie=self._cookie)
        if found is None and self._admitted >= MOST_ADMITTED:
            text = f"{MOST_ADMITTED} connections are already open"
            return Refusal(status=503, text=text)
        if found is not None and found.origin is not None:
            # The origin comes from the client: it may contain anything, and be as long as the
            # header.
            origin = ascii(found.origin)[1:-1][:_SHOWN_LENGTH]
            if self._once.allows(origin):
                self._refused(origin)
        return found

    async def _admit(self, sock: socket.socket, address: tuple[str, int], request: Request) -> None:
        asked = request.asked
        if not request.upgrades and self._access.has_token_in_query(asked.target):
            await _let_in(request, sock, f"{self._cookie}={self._access.token}")
            return
        with socket.socket(socket.AF_INET, socket.SOCK_STREAM) as server:
            server.setblocking(False)
            server.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, _INNER_BUFFER)
            server.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            loop = asyncio.get_running_loop()
            async with asyncio.timeout(_HEAD_SECONDS):
                await loop.sock_connect(server, self._server)
            port = server.getsockname()[1]
            self._peers[port] = f"{address[0]}:{address[1]}", asked.cookies
            try:
                await self._exchange(sock, server, request)
            finally:
                del self._peers[port]

    async def _exchange(self, sock: socket.socket, server: socket.socket, request: Request) -> None:
        framed = self._access.may_be_framed(request.asked.target)
        begun = await _begin(sock, server, request, framed=framed)
        if begun is None:
            return
        if self._client is None:
            await asyncio.get_running_loop().sock_sendall(server, begun)
            await relay(sock, server)
            return
        client = self._client()
        frames = Frames(client.passes, self._room, _canceller())
        try:
            with contextlib.suppress(FrameError):
                passed = frames.feed(memoryview(begun))
                await asyncio.get_running_loop().sock_sendall(server, passed)
                await relay(sock, server, frames)
        finally:
            frames.close()
            if frames.fault:
                client.broke(frames.fault)
            client.end()


def _canceller() -> Callable[[], object]:
    """Returns a function that cancels the calling task, which closes its connection."""
    return asyncio.current_task().cancel  # type: ignore[union-attr]


async def _begin(
    sock: socket.socket, server: socket.socket, request: Request, *, framed: bool
) -> bytes | None:
    """Forwards a request and its response.

    Args:
        sock: The client.
        server: The server behind.
        request: The client's request.
        framed: Whether other pages may show the response in a frame.

    Returns:
        Bytes that the client sent after a websocket handshake; None after any other response.
    """
    loop = asyncio.get_running_loop()
    inner = h11.Connection(h11.CLIENT, max_incomplete_event_size=HEAD_SIZE)
    async with asyncio.timeout(_HEAD_SECONDS):
        head = inner.send(request.forwarded("localhost"))
        end = inner.send(h11.EndOfMessage())
        await loop.sock_sendall(server, (head or b"") + (end or b""))
        answer = await next_event(inner, server)
    if isinstance(answer, h11.InformationalResponse):
        headers = [pair for pair in answer.headers if pair[0].startswith(_WEBSOCKET)]
        switched = h11.InformationalResponse(status_code=101, headers=headers, reason=answer.reason)
        await _send(request, sock, switched, inner.trailing_data[0])
        return request.connection.trailing_data[0]
    if not isinstance(answer, h11.Response):
        return None
    headers = [pair for pair in answer.headers if pair[0] in _CONTENT]
    headers += _protected(request.asked.host, framed=framed)
    kept = h11.Response(status_code=answer.status_code, headers=headers, reason=answer.reason)
    await _send(request, sock, kept)
    while isinstance(event := await next_event(inner, server), h11.Data):
        await _send(request, sock, event)
    await _send(request, sock, h11.EndOfMessage())
    return None


async def _send(request: Request, sock: socket.socket, event: h11.Event, more: bytes = b"") -> None:
    loop = asyncio.get_running_loop()
    async with asyncio.timeout(_STALL_SECONDS):
        await loop.sock_sendall(sock, (request.connection.send(event) or b"") + more)


def _protected(host: str, *, framed: bool = False) -> list[tuple[bytes, bytes]]:
    """Headers that keep out foreign web pages, and restrict the page to its own server.

    Otherwise viser's client connects to any server in the page's URL, and runs its scripts.

    Args:
        host: This server's host name in the browser.
        framed: Whether other pages may show the page in a frame.
    """
    policy = f"connect-src 'self' ws://{host} wss://{host} data: blob:"
    if not framed:
        policy += "; frame-ancestors 'self'"
    return [
        (b"Content-Security-Policy", f"{policy}; base-uri 'none'; form-action 'none'".encode()),
        (b"X-Content-Type-Options", b"nosniff"),
        (b"Referrer-Policy", b"no-referrer"),
        (b"Connection", b"close"),
    ]


async def _let_in(request: Request, sock: socket.socket, cookie: str) -> None:
    """Responds to a URL with the token: the browser stores the token and opens the bare URL."""
    headers = [
        (b"Content-Type", b"text/html; charset=utf-8"),
        (b"Content-Length", str(len(_ENTRANCE)).encode()),
        (b"Cache-Control", b"no-store"),
        (b"Set-Cookie", f"{cookie}; Path=/; HttpOnly; SameSite=Strict".encode()),
        *_protected(request.asked.host),
    ]
    await _send(request, sock, h11.Response(status_code=200, headers=headers))
    await _send(request, sock, h11.Data(data=_ENTRANCE))


async def _refuse(sock: socket.socket, refusal: Refusal) -> None:
    """Responds with a refusal, whatever the request was."""
    loop = asyncio.get_running_loop()
    text = f"{refusal.text}\n".encode(errors="replace")
    head = (
        f"HTTP/1.1 {refusal.status} {HTTPStatus(refusal.status).phrase}\r\n"
        "Content-Type: text/plain; charset=utf-8\r\nX-Content-Type-Options: nosniff\r\n"
        f"Content-Length: {len(text)}\r\nConnection: close\r\n\r\n"
    )
    with contextlib.suppress(TimeoutError):
        async with asyncio.timeout(_FAREWELL_SECONDS):
            await loop.sock_sendall(sock, head.encode() + text)
            sock.shutdown(socket.SHUT_WR)
            while await loop.sock_recv(sock, HEAD_SIZE):
                pass


def _prepare(sock: socket.socket) -> None:
    """Sets socket options: detect vanished peers, and send small messages at once."""
    sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    sock.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
    for name, value in _KEEP_ALIVE.items():
        # Some systems lack some of these options.
        if hasattr(socket, name):
            sock.setsockopt(socket.IPPROTO_TCP, getattr(socket, name), value)
