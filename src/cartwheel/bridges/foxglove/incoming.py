"""Messages, service requests and parameter values from clients."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

from cartwheel.bridges.bridged import BridgedGraph
from cartwheel.bridges.foxglove.forms import encoding_of, schema_of
from cartwheel.bridges.mirror import asked
from cartwheel.codes.graph import SERVICE_FAILED
from cartwheel.codes.wires import INCOMING_DROPPED, MALFORMED_MESSAGE, MESSAGE_UNREAD
from cartwheel.errors import CartwheelError, Diagnostic, GraphError
from cartwheel.graph import TWIST, TWIST_STAMPED, Service
from cartwheel.messages import (
    decode_cdr,
    encode_cdr,
    from_dict,
    service_classes,
    to_dict,
    type_name,
)
from cartwheel.messages.ros1 import decode_ros1, encode_ros1
from cartwheel.messages.ros2.types import ros2_name

ENCODINGS = ["json", "cdr", "ros1"]
"""Encodings of messages that clients may send. Lichtblick uses the first. JSON allows omitted
fields, while Lichtblick's CDR of a message with a missing array is invalid."""
_BACKLOG = 1000
"""Maximum number of messages that the simulation has not processed yet."""


def decode(data: bytes, encoding: str, kind: str) -> Any:
    """Decodes bytes from a client, which may be malformed.

    Raises:
        CartwheelError: The bytes are not a valid message.
    """
    if encoding == "cdr":
        # Lichtblick sends the whole buffer into which it wrote a request.
        return decode_cdr(data, kind, padded=True)
    if encoding == "ros1":
        return decode_ros1(data, kind)
    if encoding != "json":
        raise GraphError(
            f'the message encoding "{encoding}" is not supported',
            code=MALFORMED_MESSAGE,
            hint=f"Supported encodings: {', '.join(ENCODINGS)}.",
            values={"encoding": encoding},
        )
    try:
        return from_dict(kind, json.loads(data))
    except ValueError as error:
        raise GraphError(f"invalid JSON: {error}", code=MALFORMED_MESSAGE) from None


class Incoming:
    """Publishes the messages of clients on the graph.

    Args:
        graph: Graph to publish on.
        warn: Receives warnings for clients and the user.
    """

    def __init__(self, graph: BridgedGraph, warn: Callable[[Diagnostic], None]) -> None:
        self._graph = graph
        self._warn = warn
        self._channels: dict[tuple[int, int], tuple[str, str, str]] = {}
        """Topic, encoding and type, by client and channel."""
        self._waiting = 0

    def advertise(self, client: int, channel: int, topic: str, encoding: str, kind: str) -> None:
        """Adds a channel on which a client publishes."""
        self._channels[client, channel] = (topic, encoding, type_name(kind))

    def unadvertise(self, client: int, channel: int) -> None:
        """Removes a channel."""
        self._channels.pop((client, channel), None)

    def take(self, client: int, channel: int, data: bytes) -> None:
        """Publishes a message of a client."""
        known = self._channels.get((client, channel))
        if known is None:
            return
        topic, encoding, kind = known
        if self._waiting >= _BACKLOG:
            self._warn(
                INCOMING_DROPPED.diagnostic(
                    "clients send messages faster than the simulation processes them, so some "
                    "messages are dropped"
                )
            )
            return
        try:
            types = {info.name: info.type for info in self._graph.topics()}
            if topic not in types:
                self._warn(
                    MESSAGE_UNREAD.diagnostic(
                        f"{topic} has no subscribers, so messages from clients on this topic are "
                        "dropped",
                        values={"topic": topic},
                    )
                )
                return
            message = decode(data, encoding, kind)
            if (kind, types[topic]) == (TWIST, TWIST_STAMPED):
                # Clients that drive robots support only Twist.
                kind, message = TWIST_STAMPED, from_dict(TWIST_STAMPED, {"twist": to_dict(message)})
            self._waiting += 1
            self._graph.publish(topic, kind, message)
            self._graph.post(self._taken)
        except CartwheelError as error:
            self._warn(
                MALFORMED_MESSAGE.because(
                    f"a client's message on {topic} is ignored", error, values={"topic": topic}
                )
            )

    def _taken(self) -> None:
        self._waiting -= 1


def offered(graph: BridgedGraph, service: Service, warn: Callable[[Diagnostic], None]) -> Any:
    """A graph service for the server, which calls it on the server's threads.

    Args:
        graph: Graph with the service.
        service: Service to offer.
        warn: Receives the error of a failed call, on any thread. Not all clients show errors.

    Raises:
        UnknownNameError: The service type is unknown.
    """
    import foxglove

    request_class, response_class = service_classes(service.type)

    encoding = encoding_of(request_class.__msgtype__, response_class.__msgtype__)

    def schema(made: Any) -> Any:
        return foxglove.MessageSchema(
            encoding=encoding, schema=schema_of(made.__msgtype__, encoding)
        )

    def handle(request: Any) -> bytes:
        try:
            message = decode(bytes(request.payload), request.encoding, request_class.__msgtype__)
            response = asked(graph, service.name, message)
        except CartwheelError as error:
            warn(
                SERVICE_FAILED.because(
                    f"{service.name} failed", error, values={"service": service.name}
                )
            )
            raise  # The client receives this error.
        if request.encoding == "json":
            return json.dumps(to_dict(response)).encode()
        return encode_ros1(response) if request.encoding == "ros1" else encode_cdr(response)

    return foxglove.Service(
        service.name,
        schema=foxglove.ServiceSchema(
            ros2_name(service.type), request=schema(request_class), response=schema(response_class)
        ),
        handler=handle,
    )
