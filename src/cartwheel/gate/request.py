"""One request: its head is read and checked as HTTP demands, and written anew for the server."""

from __future__ import annotations

import asyncio
import socket
from dataclasses import dataclass
from http import HTTPStatus

import h11

from cartwheel.gate.access import Asked, without_token

HEAD_SIZE = 16_384
"""Bytes of a head, of a request or of an answer."""
CHUNK = 1 << 16
_PASSED = (
    b"accept-encoding",
    b"sec-websocket-key",
    b"sec-websocket-version",
    b"sec-websocket-protocol",
    b"sec-websocket-extensions",
    b"user-agent",
)
"""What the servers behind may read; all else, whatever it means to them, stays here."""


class RequestError(Exception):
    """A request that nobody needs to send.

    Args:
        status: Of the answer.
        text: What is wrong.
    """

    def __init__(self, status: HTTPStatus, text: str) -> None:
        super().__init__(text)
        self.status = status


@dataclass(frozen=True, kw_only=True, slots=True)
class Request:
    """A request that is well formed."""

    asked: Asked
    upgrades: bool
    """Whether it asks for a websocket."""
    headers: list[tuple[bytes, bytes]]
    """Those that are passed on."""
    connection: h11.Connection
    """The server's side of it, to answer with."""

    def forwarded(self, host: str) -> h11.Request:
        """What the server behind gets.

        Args:
            host: The server's name.
        """
        headers = [(b"host", host.encode()), *self.headers]
        if self.upgrades:
            headers += [(b"connection", b"Upgrade"), (b"upgrade", b"websocket")]
        else:
            headers += [(b"connection", b"close")]
        return h11.Request(method="GET", target=without_token(self.asked.target), headers=headers)


async def read_request(sock: socket.socket) -> Request:
    """Reads the head of a connection's only request.

    Raises:
        RequestError: It is malformed, too large, or of a kind that no server behind answers.
        EOFError: The connection ended before.
        OSError: The connection broke.
    """
    connection = h11.Connection(h11.SERVER, max_incomplete_event_size=HEAD_SIZE)
    try:
        event = await next_event(connection, sock)
    except h11.RemoteProtocolError as error:
        raise RequestError(HTTPStatus(error.error_status_hint), str(error)) from error
    if isinstance(event, h11.Request):
        return _checked(event, connection)
    raise EOFError


async def next_event(connection: h11.Connection, sock: socket.socket) -> h11.Event:
    """What comes next on a connection.

    Raises:
        EOFError: It ended amid something.
        OSError: It broke.
        h11.RemoteProtocolError: It is not HTTP.
    """
    loop = asyncio.get_running_loop()
    while (event := connection.next_event()) is h11.NEED_DATA:
        data = await loop.sock_recv(sock, CHUNK)
        if not data and connection.their_state is not h11.SEND_BODY:
            raise EOFError
        connection.receive_data(data)
    if isinstance(event, h11.Event):
        return event
    raise EOFError


def _checked(event: h11.Request, connection: h11.Connection) -> Request:
    # h11 bounds only a head that is not complete yet.
    size = len(event.target) + sum(len(name) + len(value) + 4 for name, value in event.headers)
    if size > HEAD_SIZE:
        status = HTTPStatus.REQUEST_HEADER_FIELDS_TOO_LARGE
        raise RequestError(status, f"the request header exceeds {HEAD_SIZE} bytes")
    if event.http_version not in (b"1.0", b"1.1"):
        raise RequestError(HTTPStatus.HTTP_VERSION_NOT_SUPPORTED, "only HTTP/1 is supported")
    if event.method != b"GET":
        raise RequestError(HTTPStatus.METHOD_NOT_ALLOWED, "only GET is supported")
    # Not an address in full: then two would say which server is meant.
    if not event.target.startswith(b"/"):
        raise RequestError(HTTPStatus.BAD_REQUEST, "the target must be a path")
    names = [name for name, _ in event.headers]
    if b"content-length" in names or b"transfer-encoding" in names:
        raise RequestError(HTTPStatus.BAD_REQUEST, "request bodies are not supported")
    for name in (b"host", b"origin", b"upgrade", b"cookie"):
        if names.count(name) > 1:
            raise RequestError(HTTPStatus.BAD_REQUEST, f"there are two {name.decode()} headers")
    found = {name: value.decode("latin-1") for name, value in event.headers}
    if b"host" not in found:
        raise RequestError(HTTPStatus.BAD_REQUEST, "the host header is missing")
    # The end of the request: from then on a websocket may begin.
    connection.next_event()
    return Request(
        asked=Asked(
            target=event.target.decode("ascii"),
            host=found[b"host"],
            origin=found.get(b"origin"),
            cookies=found.get(b"cookie", ""),
        ),
        upgrades=found.get(b"upgrade", "").lower() == "websocket",
        headers=[(name, value) for name, value in event.headers if name in _PASSED],
        connection=connection,
    )
