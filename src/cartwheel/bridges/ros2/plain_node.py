"""A node of ROS 2 with topics only, for programs on computers without ROS."""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Callable
from types import FrameType, TracebackType
from typing import Any, Generic, Self, overload

from cartwheel.bridges.loop import Loop
from cartwheel.bridges.ros2.environment import discovery_range, domain_id
from cartwheel.bridges.ros2.names import dds_topic
from cartwheel.graph import made_message, resolve_name
from cartwheel.messages import decode_cdr, encode_cdr
from cartwheel.messages.ros2.types import ros2_type
from cartwheel.messages.typed import Kind, M, name_of
from rtps_lite.discovery import EndpointQos
from rtps_lite.participant import Participant
from rtps_lite.reader import Taken
from rtps_lite.writer import Writer

_TIMEOUT = 60.0
"""Wall time to wait for the loop, s."""


class NodePublisher(Generic[M]):
    """Publishes on a topic of ROS 2. `Node.advertise` creates it."""

    def __init__(self, loop: Loop, writer: Writer, topic: str, kind: str) -> None:
        self._loop = loop
        self._writer = writer
        self.topic = topic
        """Name of the topic."""
        self.type = kind
        """Type of the messages."""

    def publish(self, message: M | dict[str, Any] | None = None, **fields: Any) -> None:
        """Publishes a message. Callable on any thread.

        Args:
            message: A message, or a mapping of its fields.
            fields: The fields instead of `message`. Join nested names with ``_``.

        Raises:
            GraphError: The message does not fit the type.
        """
        encoded = encode_cdr(made_message(self.topic, self.type, message, fields))
        self._loop.post(lambda: self._writer.write(encoded))


class Node:
    """A node of ROS 2 with topics over DDS, which requires no installation of ROS.

    It is for tests and examples that run everywhere, such as a controller in lockstep. Use rclpy
    where ROS is installed. The environment variables of ROS apply, such as ``ROS_DOMAIN_ID``.

    Args:
        name: Name of the node.

    Raises:
        CartwheelError: An environment variable is invalid.
    """

    def __init__(self, name: str = "node") -> None:
        self.name = name
        """Name of the node."""
        self._loop = Loop(_report, name=name)
        self._loop.start()

        def connect() -> Participant:
            participant = Participant(
                self._loop,
                domain=domain_id(),
                reach=discovery_range(),
                name=name,
                user_data=b"enclave=/;",
                warn=_report,
            )
            participant.start()
            return participant

        self._participant = self._loop.call(connect).result(_TIMEOUT)
        self._closed = False

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def close(self) -> None:
        """Leaves the network."""
        if not self._closed:
            self._closed = True
            self._loop.call(self._participant.close).result(_TIMEOUT)
            self._loop.stop()

    @overload
    def advertise(self, topic: str, type: type[M]) -> NodePublisher[M]: ...
    @overload
    def advertise(self, topic: str, type: str) -> NodePublisher[Any]: ...
    def advertise(self, topic: str, type: Kind) -> NodePublisher[Any]:
        """Advertises a topic, reliably, and returns its publisher.

        Args:
            topic: Topic name.
            type: A class of `cartwheel.msgs`, or a name such as ``geometry_msgs/msg/Twist``.

        Raises:
            UnknownNameError: The type does not exist.
        """
        full, kind = resolve_name(topic), ros2_type(name_of(type))
        qos = EndpointQos(reliable=True)
        writer = self._loop.call(
            lambda: self._participant.writer(dds_topic(full), kind.dds, qos)
        ).result(_TIMEOUT)
        return NodePublisher(self._loop, writer, full, kind.name)

    @overload
    def subscribe(self, topic: str, callback: Callable[[M], object], *, type: type[M]) -> None: ...
    @overload
    def subscribe(self, topic: str, callback: Callable[[Any], object], *, type: str) -> None: ...
    def subscribe(self, topic: str, callback: Callable[[Any], object], *, type: Kind) -> None:
        """Calls a function with each message, on the thread of the node.

        Args:
            topic: Topic name.
            callback: Receives each message.
            type: As for `advertise`.

        Raises:
            UnknownNameError: The type does not exist.
        """
        full, kind = resolve_name(topic), ros2_type(name_of(type))

        def take(sample: Taken) -> None:
            callback(decode_cdr(bytes(sample.payload), kind.name))

        qos = EndpointQos(reliable=True)
        self._loop.call(
            lambda: self._participant.reader(dds_topic(full), kind.dds, qos, take)
        ).result(_TIMEOUT)

    def spin(self) -> None:
        """Waits until the process receives SIGINT or SIGTERM. Call it on the main thread."""
        ended = threading.Event()

        def end(number: int, frame: FrameType | None) -> None:  # noqa: ARG001 - as Python calls it
            ended.set()

        before = {each: signal.signal(each, end) for each in (signal.SIGINT, signal.SIGTERM)}
        try:
            ended.wait()
        finally:
            for number, handler in before.items():
                signal.signal(number, handler)


def _report(warning: object) -> None:
    sys.stderr.write(f"{warning}\n")
