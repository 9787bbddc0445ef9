"""A single HTTP request: the header is read, validated, and rewritten for the server."""

from __future__ import annotations

import asyncio
import socket
from dataclasses import dataclass
from http import HTTPStatus

import h11

from cartwheel.errors import Pickled
from cartwheel.gate.access import Asked, without_secrets

HEAD_SIZE = 16_384
"""Maximum size in bytes of a request or response header."""
CHUNK = 1 << 16
_PASSED = (
    b"accept-encoding",
    b"sec-websocket-key",
    b"sec-websocket-version",
    b"sec-websocket-protocol",
    b"sec-websocket-extensions",
    b"user-agent",
)
"""Headers that are forwarded to the server behind. All others are removed."""


class RequestError(Pickled, Exception):
    """A request that legitimate clients do not send.

    Args:
        status: HTTP status of the response.
        text: Problem description.
    """

    def __init__(self, status: HTTPStatus, text: str) -> None:
        super().__init__(text)
        self.status = status


@dataclass(frozen=True, kw_only=True, slots=True)
class Request:
    """A valid request."""

    asked: Asked
    upgrades: bool
    """Whether the request is a websocket handshake."""
    headers: list[tuple[bytes, bytes]]
    """Headers to forward."""
    connection: h11.Connection
    """Server side of the connection, which writes the response."""

    def forwarded(self, host: str) -> h11.Request:
        """The request for the server behind.

        Args:
            host: Host name of the server behind.
        """
        headers = [(b"host", host.encode()), *self.headers]
        if self.upgrades:
            headers += [(b"connection", b"Upgrade"), (b"upgrade", b"websocket")]
        else:
            headers += [(b"connection", b"close")]
        return h11.Request(method="GET", target=without_secrets(self.asked.target), headers=headers)


async def read_request(sock: socket.socket) -> Request:
    """Reads the header of a connection's only request.

    Raises:
        RequestError: The request is malformed, too large, or of a kind that no server supports.
        EOFError: The connection closed before the end of the header.
        OSError: The connection failed.
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
    """Returns the next event of a connection.

    Raises:
        EOFError: The connection closed in the middle of an event.
        OSError: The connection failed.
        h11.RemoteProtocolError: The data is not valid HTTP.
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
    # h11 limits only headers that are still incomplete.
    size = len(event.target) + sum(len(name) + len(value) + 4 for name, value in event.headers)
    if size > HEAD_SIZE:
        status = HTTPStatus.REQUEST_HEADER_FIELDS_TOO_LARGE
        raise RequestError(status, f"the request header exceeds {HEAD_SIZE} bytes")
    if event.http_version not in (b"1.0", b"1.1"):
        raise RequestError(HTTPStatus.HTTP_VERSION_NOT_SUPPORTED, "only HTTP/1 is supported")
    if event.method != b"GET":
        raise RequestError(HTTPStatus.METHOD_NOT_ALLOWED, "only GET is supported")
    # An absolute URL is not accepted, because it and the Host header may name different servers.
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
    # Consume the end of the request. A websocket may begin after it.
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
