"""A subscribed topic of the node: passes messages from all publishers to the graph."""

from __future__ import annotations

import contextlib
import socket
from collections.abc import Callable, Sequence
from typing import Any

from cartwheel.bridges.loop import Loop
from cartwheel.bridges.ros1.address import host_and_port
from cartwheel.bridges.ros1.attempts import Attempts
from cartwheel.bridges.ros1.connection import Connection, Traffic
from cartwheel.bridges.ros1.header import encode_header
from cartwheel.bridges.ros1.rpc import TIMEOUT, Peer, connect
from cartwheel.codes.wires import (
    MALFORMED_MESSAGE,
    PEER_ADDRESS_INVALID,
    PEER_LIMIT,
    PEER_TYPE_MISMATCH,
)
from cartwheel.errors import CartwheelError, Diagnostic
from cartwheel.messages.ros1 import Ros1Type, decode_ros1

_AGAIN = (0.2, 1.0, 2.0, 5.0)
"""Delays in s between attempts to connect to a publisher. The last delay repeats."""
MOST = 256
"""Maximum number of publishers per topic."""
_LONGEST = 300
"""Maximum length of a publisher's URI in characters."""
_ANSWER = 64 << 10
"""Maximum size of a publisher's response in bytes."""
_ELEMENTS = 200_000
"""Maximum number of elements in the lists of a message (names, points, transforms). Numbers do
not count."""


class _Link:
    """A publisher and the connection to it."""

    def __init__(self, uri: str, host: str) -> None:
        self.uri = uri
        self.host = host
        self.connection: Connection | None = None
        self.attempts = 0
        self.wanted = True


class TopicSubscription:
    """A subscribed topic. Used on the loop's thread, except for connecting to publishers.

    Args:
        loop: Event loop of the node.
        traffic: Connection limits of the node.
        attempts: Connection attempts of the node.
        topic: ROS name of the topic.
        type_name: Type name in the graph.
        type_: ROS 1 type.
        node: Name of the node.
        own_uri: URI of this node, which is not subscribed to.
        deliver: Called with each message and its size in bytes.
        warn: Receives warnings.
    """

    def __init__(
        self,
        loop: Loop,
        traffic: Traffic,
        attempts: Attempts,
        *,
        topic: str,
        type_name: str,
        type_: Ros1Type,
        node: str,
        own_uri: str,
        deliver: Callable[[Any, int], None],
        warn: Callable[[Diagnostic], None],
    ) -> None:
        self._loop = loop
        self._traffic = traffic
        self._attempts = attempts
        self.topic = topic
        self.type_name = type_name
        self.type = type_
        self._node = node
        self._own_uri = own_uri
        self._deliver = deliver
        self._warn = warn
        self._links: dict[str, _Link] = {}

    @property
    def connections(self) -> list[tuple[str, Connection]]:
        """Connected publishers by URI."""
        return [(link.uri, link.connection) for link in self._links.values() if link.connection]

    def update(self, uris: Sequence[str], *, drop: bool = True) -> None:
        """Connects to publishers.

        Args:
            uris: URIs of the publishing nodes.
            drop: Whether to disconnect from all other publishers.
        """
        named = dict.fromkeys(uri for uri in uris if uri != self._own_uri)
        for uri in [uri for uri in self._links if uri not in named] if drop else ():
            self._drop(self._links.pop(uri))
        for uri in named:
            if uri not in self._links:
                self._add(uri)

    def _add(self, uri: str) -> None:
        if len(self._links) >= MOST:
            self._warn(
                PEER_LIMIT.diagnostic(
                    f"{self.topic} has more than {MOST} publishers, so some of them are not "
                    "connected",
                    values={"topic": self.topic, "most": MOST},
                )
            )
            return
        try:
            host, _ = host_and_port(uri[: _LONGEST + 1])
        except CartwheelError as error:
            self._warn(
                PEER_ADDRESS_INVALID.because(
                    f"a publisher of {self.topic} cannot be reached",
                    error,
                    hint="",
                    values={"topic": self.topic},
                )
            )
            return
        if len(uri) > _LONGEST or not uri.startswith("http://"):
            self._warn(
                PEER_ADDRESS_INVALID.diagnostic(
                    f"a publisher of {self.topic} has the invalid address {uri[:_LONGEST]}",
                    values={"topic": self.topic, "uri": uri[:_LONGEST]},
                )
            )
            return
        link = self._links[uri] = _Link(uri, host)
        self._reach(link)

    def close(self) -> None:
        """Disconnects from all publishers."""
        for link in self._links.values():
            self._drop(link)
        self._links.clear()

    @staticmethod
    def _drop(link: _Link) -> None:
        link.wanted = False
        if link.connection is not None:
            link.connection.close()

    def _reach(self, link: _Link) -> None:
        if link.wanted and link.connection is None:
            self._attempts.add(link.host, lambda: self._negotiate(link), hopeless=link.attempts > 0)

    def _negotiate(self, link: _Link) -> None:
        """Requests the port of a publisher and connects. Called on a thread of the attempts."""
        if not link.wanted:
            return
        peer = Peer(link.uri, largest=_ANSWER)
        try:
            answer = peer.call("requestTopic", self._node, self.topic, [["TCPROS"]])
            protocol, host, port = answer[:3]
            if protocol != "TCPROS":
                raise ValueError(protocol)
            sock = connect(str(host), int(port), TIMEOUT)
        except (CartwheelError, OSError, ValueError, TypeError, IndexError, OverflowError):
            self._loop.post(lambda: self._retry(link))
            return
        finally:
            peer.close()
        self._loop.post(lambda: self._connected(link, sock))

    def _retry(self, link: _Link) -> None:
        if link.wanted:
            wait = _AGAIN[min(link.attempts, len(_AGAIN) - 1)]
            link.attempts += 1
            self._loop.after(wait, lambda: self._reach(link))

    def _connected(self, link: _Link, sock: socket.socket) -> None:
        if not link.wanted or self._traffic.full:
            with contextlib.suppress(OSError):
                sock.close()
            self._retry(link)
            return
        connection = Connection(self._loop, sock, self._traffic, on_header=self._begun)
        link.connection = connection
        connection.peer = link.uri

        def lost() -> None:
            link.connection = None
            self._retry(link)

        def take(data: bytes) -> None:
            link.attempts = 0
            self._take(connection, data)

        connection.on_close = lost
        connection.on_block = take
        connection.send(
            encode_header(
                {
                    "callerid": self._node,
                    "md5sum": self.type.md5,
                    "message_definition": self.type.definition,
                    "tcp_nodelay": "1",
                    "topic": self.topic,
                    "type": self.type.name,
                }
            )
        )

    def _begun(self, connection: Connection, fields: dict[str, str]) -> None:
        refused = fields.get("error")
        theirs = fields.get("md5sum", "*")
        if refused is None and theirs not in ("*", self.type.md5):
            refused = f"it publishes {fields.get('type')} with md5 sum {theirs}"
        if refused is not None:
            self._warn(
                PEER_TYPE_MISMATCH.diagnostic(
                    f"{connection.peer} publishes {self.topic} with a different type from "
                    f"{self.type.name} ({self.type.md5}): {refused}",
                    values={
                        "peer": connection.peer,
                        "topic": self.topic,
                        "type": self.type.name,
                        "reason": refused,
                    },
                )
            )
            connection.close()

    def _take(self, connection: Connection, data: bytes) -> None:
        try:
            message = decode_ros1(data, self.type_name, elements=_ELEMENTS)
        except CartwheelError as error:
            self._warn(
                MALFORMED_MESSAGE.because(
                    f"{connection.peer} sent a malformed message on {self.topic}",
                    error,
                    values={"peer": connection.peer, "topic": self.topic},
                )
            )
            connection.close()
            return
        self._deliver(message, len(data))
