"""A service of the node."""

from __future__ import annotations

import struct
import threading
from collections.abc import Callable
from typing import Any

from cartwheel.bridges.loop import Loop
from cartwheel.bridges.ros1.connection import Connection
from cartwheel.bridges.ros1.header import encode_header
from cartwheel.errors import one_line
from cartwheel.messages.ros1 import Ros1Service, decode_ros1, encode_ros1

_LENGTH = struct.Struct("<I")
_MOST = 32
"""Maximum number of simultaneous calls."""
_MOST_OF_ALL = 64
_ELEMENTS = 200_000
"""Maximum number of elements in the lists of a request. Numbers do not count."""

Answer = Callable[[Any], Any]


class Calls:
    """Counts the running calls of all services of a node. Used on the loop's thread."""

    def __init__(self) -> None:
        self.running = 0

    @property
    def full(self) -> bool:
        """Whether the limit on calls is reached."""
        return self.running >= _MOST_OF_ALL


class OfferedService:
    """An offered service. Used on the loop's thread, except that each call has its own thread.

    A client's next call begins after the response of its previous call.

    Args:
        loop: Event loop of the node.
        calls: Call counter of the node.
        name: ROS name of the service.
        type_: Service type.
        answer: Takes a request and returns the response. It may be slow, and may raise.
        node: Name of the node.
    """

    def __init__(
        self,
        loop: Loop,
        calls: Calls,
        *,
        name: str,
        type_: Ros1Service,
        answer: Answer,
        node: str,
    ) -> None:
        self._loop = loop
        self._calls = calls
        self.name = name
        self.type = type_
        self._answer = answer
        self._links: list[Connection] = []
        self._running = 0
        self._header = encode_header(
            {
                "callerid": node,
                "md5sum": type_.md5,
                "request_type": f"{type_.name}Request",
                "response_type": f"{type_.name}Response",
                "service": name,
                "type": type_.name,
            }
        )

    def join(self, link: Connection, fields: dict[str, str]) -> None:
        """Adds a client, after checking the type in its header."""
        if fields.get("md5sum", "*") not in ("*", self.type.md5):
            link.refuse(
                f"service {self.name} has type {self.type.name} with md5 sum {self.type.md5},"
                f" not {fields['md5sum']}"
            )
            return
        persistent = fields.get("persistent", "0").lower() in ("1", "true")
        self._links.append(link)
        link.on_close = lambda: self._links.remove(link)
        link.on_block = lambda data: self._call(link, data, persistent)
        link.send(self._header)

    def probe(self, link: Connection) -> None:
        """Sends the type to a client that only probes the service."""
        link.send(self._header)
        link.finish()

    def close(self) -> None:
        """Closes all connections of the service."""
        for link in self._links[:]:
            link.close()

    def _call(self, link: Connection, data: bytes, persistent: bool) -> None:
        if self._running >= _MOST or self._calls.full:
            self._respond(link, _failure("too many concurrent calls"), persistent)
            return
        self._running += 1
        self._calls.running += 1
        link.hold()
        threading.Thread(
            target=self._work, args=(link, data, persistent), name="ros1 service", daemon=True
        ).start()

    def _work(self, link: Connection, data: bytes, persistent: bool) -> None:
        try:
            response = self._answer(decode_ros1(data, self.type.request, elements=_ELEMENTS))
            body = encode_ros1(response)
            reply = b"\1" + _LENGTH.pack(len(body)) + body
        except Exception as error:  # noqa: BLE001 - the caller waits for a response
            reply = _failure(one_line(error))

        def done() -> None:
            self._running -= 1
            self._calls.running -= 1
            self._respond(link, reply, persistent)
            link.go_on()

        self._loop.post(done)

    @staticmethod
    def _respond(link: Connection, reply: bytes, persistent: bool) -> None:
        link.send(reply)
        if not persistent:
            link.finish()


def _failure(reason: str) -> bytes:
    text = reason.encode(errors="replace")
    return b"\0" + _LENGTH.pack(len(text)) + text
