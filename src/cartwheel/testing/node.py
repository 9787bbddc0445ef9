"""A node of ROS 2 with topics only, for programs on computers without ROS."""

from __future__ import annotations

import functools
import signal
import sys
import threading
from collections.abc import Callable, Sequence
from pathlib import Path
from types import FrameType, TracebackType
from typing import TYPE_CHECKING, Any, Generic, Self, overload

from cartwheel.bridges.loop import Loop
from cartwheel.bridges.ros2.environment import discovery_range, domain_id
from cartwheel.bridges.ros2.names import dds_topic, topic_of, type_of
from cartwheel.graph import made_message, resolve_name
from cartwheel.messages import decode_cdr, encode_cdr
from cartwheel.messages.ros2.types import Ros2Type, ros2_type
from cartwheel.messages.store import is_bundled, type_name
from cartwheel.messages.typed import Kind, M, name_of
from rtps_lite.discovery import Endpoint, EndpointQos
from rtps_lite.participant import Participant
from rtps_lite.reader import Reader, Taken
from rtps_lite.writer import Writer

if TYPE_CHECKING:
    from cartwheel.messages.library.library import TypeLibrary

_TIMEOUT = 60.0
"""Wall time to wait for the loop, s."""
_DEPTH = 10
"""Number of messages that a publisher keeps for slow subscribers."""
_RELIABILITY = "RELIABILITY"
_MOST_WARNINGS = 100


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
        package_path: Folders with packages that define message types. They are searched before the
            workspace of the current folder and ``ROS_PACKAGE_PATH``.

    Raises:
        CartwheelError: An environment variable is invalid.
    """

    def __init__(self, name: str = "node", *, package_path: Sequence[str | Path] = ()) -> None:
        self.name = name
        """Name of the node."""
        self._package_path = [Path(each) for each in package_path]
        self._subscriptions: list[_Subscription] = []
        self._reported: set[str] = set()
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
            participant.on_endpoints = self._update
            participant.on_misfit = self._misfit
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

    def message_class(self, type: str) -> Any:
        """Returns the class of a message type, such as one of your own packages.

        Args:
            type: Such as ``my_msgs/msg/Status``.

        Raises:
            UnknownNameError: The type does not exist.
            GraphError: The definition of the type is invalid.
        """
        return self._types.message_class(name_of(type))

    @functools.cached_property
    def _types(self) -> TypeLibrary:
        """The types of packages. Few nodes use them, and the imports take time."""
        from cartwheel.description.files.package_files import SimulationPackages
        from cartwheel.messages.library.library import TypeLibrary

        return TypeLibrary(SimulationPackages(self._package_path), _report)

    def _type(self, given: Kind) -> tuple[str, Ros2Type]:
        """The name of a type in the graph, and its names in ROS 2."""
        name = type_name(name_of(given))
        if not is_bundled(name):
            self._types.find(name)
        return name, ros2_type(name)

    @overload
    def advertise(
        self, topic: str, type: type[M], *, latched: bool = False
    ) -> NodePublisher[M]: ...
    @overload
    def advertise(self, topic: str, type: str, *, latched: bool = False) -> NodePublisher[Any]: ...
    def advertise(self, topic: str, type: Kind, *, latched: bool = False) -> NodePublisher[Any]:
        """Advertises a topic, reliably, and returns its publisher.

        Args:
            topic: Topic name.
            type: A class of `cartwheel.msgs`, or a name such as ``geometry_msgs/msg/Twist``.
            latched: Whether later subscribers receive the last message (transient local).

        Raises:
            UnknownNameError: The type does not exist.
            GraphError: The definition of the type is invalid.
        """
        full = resolve_name(topic)
        name, kind = self._type(type)
        qos = EndpointQos(reliable=True, transient_local=latched, depth=1 if latched else _DEPTH)
        writer = self._loop.call(
            lambda: self._participant.writer(dds_topic(full), kind.dds, qos)
        ).result(_TIMEOUT)
        return NodePublisher(self._loop, writer, full, name)

    @overload
    def subscribe(
        self,
        topic: str,
        callback: Callable[[M], object],
        *,
        type: type[M],
        reliable: bool | None = None,
        latched: bool = False,
    ) -> None: ...
    @overload
    def subscribe(
        self,
        topic: str,
        callback: Callable[[Any], object],
        *,
        type: str,
        reliable: bool | None = None,
        latched: bool = False,
    ) -> None: ...
    def subscribe(
        self,
        topic: str,
        callback: Callable[[Any], object],
        *,
        type: Kind,
        reliable: bool | None = None,
        latched: bool = False,
    ) -> None:
        """Calls a function with each message, on the thread of the node.

        Args:
            topic: Topic name.
            callback: Receives each message.
            type: As for `advertise`.
            reliable: Whether messages must be delivered reliably. None is what each publisher
                offers: sensors are best effort. With True, publishers that offer less are ignored
                with a warning.
            latched: Whether to receive messages that were published before (transient local). Only
                publishers that keep their messages are received then, such as that of ``/map``.

        Raises:
            UnknownNameError: The type does not exist.
            GraphError: The definition of the type is invalid.
        """
        full = resolve_name(topic)
        name, kind = self._type(type)

        def take(data: bytes) -> None:
            callback(decode_cdr(data, name))

        made = _Subscription(
            self._participant, dds_topic(full), kind.dds, take, reliable=reliable, latched=latched
        )

        def begin() -> None:
            self._subscriptions.append(made)
            made.update()

        self._loop.call(begin).result(_TIMEOUT)

    def _update(self) -> None:
        """Called on the loop's thread when publishers or subscribers have changed."""
        for each in self._subscriptions:
            each.update()

    def _misfit(self, ours: Endpoint, other: Endpoint, policy: str) -> None:
        """Called on the loop's thread with a publisher or subscriber that does not fit."""
        if policy == _RELIABILITY and any(
            each.topic == ours.topic and each.reliable is None for each in self._subscriptions
        ):
            return  # another reader receives its messages
        topic = topic_of(ours.topic)
        if not topic:
            return
        does = "reads" if ours.is_writer else "publishes"
        found = f"{policy} does not fit" if policy else f"its type is {type_of(other.type)}"
        warning = f"{self.name}: a node {does} {topic}, but {found}, so no messages are exchanged"
        if warning not in self._reported and len(self._reported) < _MOST_WARNINGS:
            self._reported.add(warning)
            _report(warning)

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


class _Subscription:
    """Readers of a topic. Used on the loop's thread, except for the constructor.

    A reader cannot receive reliably from one publisher and with best effort from another one. So
    there is one reader for each kind of publisher. Before a publisher is known, it is the one with
    best effort, which fits all of them.

    Args:
        participant: The participant of the node.
        topic: The topic in DDS.
        type: The type in DDS.
        take: Receives each sample.
        reliable: Whether to subscribe reliably; None as publishers offer.
        latched: Whether to request earlier samples.
    """

    def __init__(
        self,
        participant: Participant,
        topic: str,
        type: str,
        take: Callable[[bytes], None],
        *,
        reliable: bool | None,
        latched: bool,
    ) -> None:
        self.topic, self.reliable = topic, reliable
        self._participant, self._type = participant, type
        self._take, self._latched = take, latched
        self._readers: dict[bool, Reader] = {}
        """By whether they are reliable."""

    def update(self) -> None:
        """Subscribes as the publishers offer, after they have changed."""
        if self.reliable is not None:
            wanted = {self.reliable}
        else:
            writers, _ = self._participant.others()
            wanted = {
                each.qos.reliable
                for each in writers
                if (each.topic, each.type) == (self.topic, self._type)
            } or {False}
        for reliable in wanted - self._readers.keys():
            qos = EndpointQos(reliable=reliable, transient_local=self._latched)
            take = self._take_reliable if reliable else self._take_other
            self._readers[reliable] = self._participant.reader(self.topic, self._type, qos, take)
        for reliable in self._readers.keys() - wanted:
            self._participant.remove(self._readers.pop(reliable))

    def _take_reliable(self, sample: Taken) -> None:
        self._take(bytes(sample.payload))

    def _take_other(self, sample: Taken) -> None:
        # Reliable publishers send to both readers.
        if True not in self._readers or sample.writer not in self._readers[True].proxies:
            self._take(bytes(sample.payload))


def _report(warning: object) -> None:
    sys.stderr.write(f"{warning}\n")
