"""A ROS 1 node: its topics and services, and its XML-RPC interface."""

from __future__ import annotations

import os
import socket
import time
from collections.abc import Callable
from typing import Any

from cartwheel.bridges.loop import Loop
from cartwheel.bridges.mirror import Copies
from cartwheel.bridges.ros1.attempts import Attempts
from cartwheel.bridges.ros1.connection import Connection, Listener, Traffic
from cartwheel.bridges.ros1.http import RpcConnection
from cartwheel.bridges.ros1.publication import Publication
from cartwheel.bridges.ros1.service import Calls, OfferedService
from cartwheel.bridges.ros1.subscription import TopicSubscription
from cartwheel.codes.wires import PEER_LIMIT
from cartwheel.errors import Diagnostic

_UNKNOWN = 100
"""Maximum number of connections whose header is missing."""
_CALLERS = 200
"""Maximum number of connections to the XML-RPC interface. Clients reconnect when necessary."""
_SWEEP = 2.0
"""Interval in s at which timeouts of peers are checked."""


class Node:
    """A ROS 1 node. Used on the loop's thread.

    Args:
        loop: Event loop of the node.
        name: Full name, with namespace.
        host: Host name or address under which other nodes reach this node.
        address: Address to listen on.
        master_uri: URI of the master.
        on_shutdown: Called with the reason when a different node requests a shutdown.
        warn: Receives warnings.
    """

    def __init__(
        self,
        loop: Loop,
        *,
        name: str,
        host: str,
        address: str,
        master_uri: str,
        on_shutdown: Callable[[str], None],
        warn: Callable[[Diagnostic], None],
    ) -> None:
        self._loop = loop
        self.name = name
        self._host = host
        self._master_uri = master_uri
        self._on_shutdown = on_shutdown
        self._warn = warn
        self.traffic = Traffic()
        self.attempts = Attempts()
        self.calls = Calls()
        self.publications: Copies[Publication] = Copies()
        self.subscriptions: Copies[TopicSubscription] = Copies()
        self.services: Copies[OfferedService] = Copies()
        self._unknown: dict[Connection, None] = {}
        self._callers: dict[RpcConnection, None] = {}
        self._streams = Listener(loop, address, self._take_stream)
        self._callers_door = Listener(loop, address, self._take_caller)
        self.ports = self._callers_door.port, self._streams.port
        """Ports of the XML-RPC interface, and of topics and services."""
        loop.post(self._sweep)
        self.uri = f"http://{host}:{self._callers_door.port}/"
        self.service_uri = f"rosrpc://{host}:{self._streams.port}"
        self._methods: dict[str, Callable[..., Any]] = {
            "getBusInfo": self._bus_info,
            "getBusStats": self._bus_stats,
            "getMasterUri": lambda _caller: (1, "", self._master_uri),
            "getPid": lambda _caller: (1, "", os.getpid()),
            "getPublications": self._list_publications,
            "getSubscriptions": self._list_subscriptions,
            "paramUpdate": lambda _caller, _name, _value: (1, "", 0),
            "publisherUpdate": self._update_publishers,
            "requestTopic": self._request_topic,
            "shutdown": self._shut_down,
        }

    def close(self) -> None:
        """Closes all connections."""
        self.attempts.close()
        for copies in (self.publications, self.subscriptions, self.services):
            for each in copies.values():
                each.close()
        for connection in list(self._unknown):
            connection.close()
        for caller in list(self._callers):
            caller.close()

    def _take_stream(self, sock: socket.socket) -> None:
        if len(self._unknown) >= _UNKNOWN or (self.traffic.full and self._unknown):
            next(iter(self._unknown)).close()
        if self.traffic.full:
            sock.close()
            self._warn(
                PEER_LIMIT.diagnostic(
                    f"other nodes have opened {self.traffic.most} connections, the maximum, so "
                    "additional connections are refused",
                    values={"most": self.traffic.most},
                )
            )
            return
        connection = Connection(self._loop, sock, self.traffic, on_header=self._assign)
        self._unknown[connection] = None
        connection.on_close = lambda: self._unknown.pop(connection, None) and None

    def _assign(self, connection: Connection, fields: dict[str, str]) -> None:
        """Assigns a connection to the requested topic or service."""
        self._unknown.pop(connection, None)
        connection.on_close = lambda: None
        if "service" in fields:
            service = self.services.get(fields["service"])
            if service is None:
                connection.refuse(f"{self.name} does not provide the service {fields['service']}")
            elif fields.get("probe") == "1":
                service.probe(connection)
            else:
                service.join(connection, fields)
        elif "topic" in fields:
            publication = self.publications.get(fields["topic"])
            if publication is None:
                connection.refuse(f"{self.name} does not publish {fields['topic']}")
            else:
                publication.join(connection, fields)
        else:
            connection.refuse("the header must contain a topic or a service")

    def _take_caller(self, sock: socket.socket) -> None:
        if len(self._callers) >= _CALLERS:
            next(iter(self._callers)).close()
        caller = RpcConnection(
            self._loop, sock, self._handle, lambda gone: self._callers.pop(gone, None) and None
        )
        self._callers[caller] = None

    def _sweep(self) -> None:
        self.traffic.sweep()
        now = time.monotonic()
        for caller in list(self._callers):
            if caller.overdue(now):
                caller.close()
        self._loop.after(_SWEEP, self._sweep)

    def _handle(self, method: str, arguments: tuple[Any, ...]) -> Any:
        known = self._methods.get(method)
        if known is None:
            raise ValueError(f"method {method} is unknown")
        return known(*arguments)

    def _request_topic(self, _caller: str, topic: str, protocols: list[list[str]]) -> Any:
        if topic not in self.publications:
            return 0, f"{self.name} does not publish {topic}", []
        if not any(protocol and protocol[0] == "TCPROS" for protocol in protocols):
            return 0, "only the protocol TCPROS is supported", []
        return 1, "", ["TCPROS", self._host, self._streams.port]

    def _update_publishers(self, _caller: str, topic: str, publishers: list[str]) -> Any:
        subscription = self.subscriptions.get(topic)
        if subscription is not None:
            subscription.update([str(uri) for uri in publishers])
        return 1, "", 0

    def _shut_down(self, _caller: str, reason: str = "") -> Any:
        # Send the response first.
        self._loop.after(0.05, lambda: self._on_shutdown(str(reason)))
        return 1, "", 0

    def _list_publications(self, _caller: str) -> Any:
        return 1, "", [[name, one.type.name] for name, one in self.publications.items()]

    def _list_subscriptions(self, _caller: str) -> Any:
        return 1, "", [[name, one.type.name] for name, one in self.subscriptions.items()]

    def _bus_info(self, _caller: str) -> Any:
        entries = [
            (link.peer, "o", publication.topic)
            for publication in self.publications.values()
            for link in publication.links
        ] + [
            (uri, "i", subscription.topic)
            for subscription in self.subscriptions.values()
            for uri, _ in subscription.connections
        ]
        return (
            1,
            "",
            [
                [number, peer, way, "TCPROS", topic, 1, f"TCPROS connection with {peer}"]
                for number, (peer, way, topic) in enumerate(entries, 1)
            ],
        )

    def _bus_stats(self, _caller: str) -> Any:
        sent = [
            [name, 0, [[i, link.sent % (1 << 31), 0, 1] for i, link in enumerate(one.links, 1)]]
            for name, one in self.publications.items()
        ]
        received = [
            [name, [[i, 0, -1, -1, 1] for i, _ in enumerate(one.connections, 1)]]
            for name, one in self.subscriptions.items()
        ]
        return 1, "", [sent, received, [0, 0, 0]]
