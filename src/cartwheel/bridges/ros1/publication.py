"""A published topic of the node: sends messages from the graph to connected nodes."""

from __future__ import annotations

import struct
from collections.abc import Callable
from typing import Any

from cartwheel.bridges.bridged import BridgedGraph
from cartwheel.bridges.loop import Loop
from cartwheel.bridges.ros1.connection import Connection
from cartwheel.bridges.ros1.header import encode_header
from cartwheel.bridges.tap import Tap
from cartwheel.codes.wires import MESSAGE_NOT_SENT, PEER_TYPE_MISMATCH, SLOW_SUBSCRIBER
from cartwheel.errors import Diagnostic, GraphError
from cartwheel.messages.ros1 import Ros1Type, write_ros1

_LENGTH = struct.Struct("<I")


class Publication:
    """A published topic. Used on the loop's thread.

    It subscribes to the graph only while a node is connected.

    Args:
        topic: ROS name of the topic.
        type_: Type of the messages.
        latched: Whether new subscribers receive the last message.
        node: Name of the node.
        warn: Receives warnings.
    """

    def __init__(
        self,
        *,
        topic: str,
        type_: Ros1Type,
        latched: bool,
        node: str,
        warn: Callable[[Diagnostic], None],
    ) -> None:
        self.topic = topic
        self.type = type_
        self.latched = latched
        self.links: list[Connection] = []
        self._warn = warn
        self._header = encode_header(
            {
                "callerid": node,
                "latching": str(int(latched)),
                "md5sum": type_.md5,
                "message_definition": type_.definition,
                "topic": topic,
                "type": type_.name,
            }
        )
        self._last: bytes | None = None
        self._missed = 0
        """Messages dropped by subscribers that have disconnected."""
        self._seq = 0
        self._faulty = False

    def join(self, link: Connection, fields: dict[str, str]) -> None:
        """Adds a subscriber, after checking the type in its header."""
        wanted = (fields.get("type", "*"), fields.get("md5sum", "*"))
        for word, own in zip(wanted, (self.type.name, self.type.md5), strict=True):
            if word not in ("*", own):
                link.refuse(
                    f"topic {self.topic} has type {self.type.name} with md5 sum {self.type.md5},"
                    f" not {wanted[0]} with {wanted[1]}"
                )
                self._warn(
                    PEER_TYPE_MISMATCH.diagnostic(
                        f"{link.peer} cannot subscribe to {self.topic}: it expects {wanted[0]} "
                        f"({wanted[1]}), but the type is {self.type.name} ({self.type.md5})",
                        values={
                            "peer": link.peer,
                            "topic": self.topic,
                            "type": wanted[0],
                            "md5": wanted[1],
                        },
                    )
                )
                return
        link.send(self._header)
        if link.closed:
            return
        link.on_close = lambda: self._leave(link)
        link.on_drop = lambda: self._warn(
            SLOW_SUBSCRIBER.diagnostic(
                f"{link.peer or 'a node'} receives {self.topic} too slowly, so messages to this "
                "node are dropped",
                values={"peer": link.peer, "topic": self.topic},
            )
        )
        if self._last is not None:
            link.send(self._last)
        if not link.closed:
            self.links.append(link)
            if len(self.links) == 1:
                self.begin()

    @property
    def dropped(self) -> int:
        """Number of messages dropped because subscribers were too slow."""
        return self._missed + sum(link.dropped for link in self.links[:])

    def begin(self) -> None:
        """Called when the first subscriber connects."""

    def end(self) -> None:
        """Called when the last subscriber disconnects."""

    def send(self, message: Any) -> None:
        """Sends a message of the graph to all subscribers. It is serialised once."""
        self._seq += 1
        try:
            parts = write_ros1(message, seq=self._seq)
        except GraphError as error:
            if not self._faulty:
                self._faulty = True
                self._warn(
                    MESSAGE_NOT_SENT.because(
                        f"a message on {self.topic} cannot be sent",
                        error,
                        values={"topic": self.topic},
                    )
                )
            return
        data = b"".join([_LENGTH.pack(sum(map(_size, parts))), *parts])
        if self.latched:
            self._last = data
        for link in self.links[:]:
            link.send(data)

    def close(self) -> None:
        """Closes all connections of the topic."""
        for link in self.links[:]:
            link.close()

    def _leave(self, link: Connection) -> None:
        if link in self.links:
            self.links.remove(link)
            self._missed += link.dropped
            if not self.links:
                self.end()


class GraphPublication(Publication):
    """A topic of the graph.

    Args:
        graph: Graph with the topic.
        source: Topic name in the graph.
        node: Node name of the bridge in the graph.
        ignored: Whether a message came from ROS, and so must not be sent back.
        rest: See `Publication`.
    """

    def __init__(
        self,
        loop: Loop,
        graph: BridgedGraph,
        *,
        source: str,
        type_name: str,
        reader: str,
        ignored: Callable[[Any], bool],
        topic: str,
        type_: Ros1Type,
        latched: bool,
        node: str,
        warn: Callable[[Diagnostic], None],
    ) -> None:
        super().__init__(topic=topic, type_=type_, latched=latched, node=node, warn=warn)
        self._tap = Tap(
            loop,
            graph,
            topic=source,
            type_name=type_name,
            reader=reader,
            ignored=ignored,
            take=self._pass_on,
            warn=warn,
            beyond=lambda: self.dropped,
        )

    def begin(self) -> None:
        """Subscribes in the graph."""
        self._tap.open()

    def end(self) -> None:
        """Unsubscribes, so that the graph does not make unused messages."""
        self._tap.close()
        self._last = None

    def _pass_on(self, message: Any) -> None:
        if self.links:
            self.send(message)


def _size(part: bytes | memoryview) -> int:
    return part.nbytes if isinstance(part, memoryview) else len(part)
