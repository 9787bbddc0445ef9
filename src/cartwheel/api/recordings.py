"""Recordings that a program reads."""

from __future__ import annotations

import builtins
import functools
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Generic, NamedTuple, Self, overload

import numpy as np

from cartwheel import arrays
from cartwheel.api.values import Moment, scalar
from cartwheel.bridges.recording.decoding import decoder
from cartwheel.bridges.recording.opening import open_recording
from cartwheel.bridges.recording.reading import RecordedTopic, span_of
from cartwheel.codes.graph import TOPIC_TYPE_MISMATCH, TOPIC_UNKNOWN
from cartwheel.codes.recording import RECORDING_EMPTY
from cartwheel.errors import GraphError, RecordingError, UnknownNameError
from cartwheel.geometry import Array, Pose
from cartwheel.graph.transform_buffer import TransformBuffer
from cartwheel.messages.times import is_stamp, nanoseconds
from cartwheel.messages.typed import Kind, M, name_of
from cartwheel.simulation.clock import NANOSECONDS


class RecordedMessage(NamedTuple, Generic[M]):
    """A message in a recording.

    For type checkers, ``RecordedMessage[Odometry]`` has a message of this class of
    `cartwheel.msgs`, and a `RecordedMessage` without a class one of any type.
    """

    time: float
    """Time at which it was recorded, s: the simulation time for recordings of Cartwheel."""
    topic: str
    """Name of its topic."""
    message: M
    """The message, as from `World.subscribe`."""


class Recording:
    """A recording in any format that `cartwheel info` reads, also of other programs.

    Only the index is held in memory. Use it on one thread, and close it, or use it in a ``with``
    block.

    Args:
        path: An MCAP file, a ROS 1 bag, an SQLite file of rosbag2, or a folder of rosbag2.

    Raises:
        RecordingError: The file is not a recording, or cannot be read.
    """

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        """The file or folder."""
        self._recording = open_recording(path)

    def __repr__(self) -> str:
        return f"<Recording {self.path} of {len(self.topics)} topics>"

    @property
    def complete(self) -> bool:
        """Whether the recording was closed properly. An incomplete one can be read as well."""
        return self._recording.complete

    @property
    def topics(self) -> tuple[str, ...]:
        """Names of the topics with messages."""
        return tuple(sorted({each.name for each in self._recording.topics if each.count}))

    @property
    def start(self) -> float:
        """Time of the first message, s.

        Raises:
            RecordingError: There are no messages.
        """
        return self._span()[0] / NANOSECONDS

    @property
    def end(self) -> float:
        """Time of the last message, s.

        Raises:
            RecordingError: There are no messages.
        """
        return self._span()[1] / NANOSECONDS

    def type(self, topic: str) -> str:
        """The message type of a topic, such as ``nav_msgs/msg/Odometry``.

        Raises:
            UnknownNameError: The recording does not contain the topic.
        """
        return self._found(topic)[-1][1].type

    def count(self, topic: str) -> int:
        """The number of messages on a topic.

        Raises:
            UnknownNameError: The recording does not contain the topic.
        """
        return sum(each.count for _, each in self._found(topic))

    @overload
    def messages(
        self,
        *topics: str,
        type: builtins.type[M],
        start: Moment | None = None,
        end: Moment | None = None,
    ) -> Iterator[RecordedMessage[M]]: ...
    @overload
    def messages(
        self,
        *topics: str,
        type: str | None = None,
        start: Moment | None = None,
        end: Moment | None = None,
    ) -> Iterator[RecordedMessage[Any]]: ...
    def messages(
        self,
        *topics: str,
        type: Kind | None = None,
        start: Moment | None = None,
        end: Moment | None = None,
    ) -> Iterator[RecordedMessage[Any]]:
        """Yields messages in the order of time.

        With a class of `cartwheel.msgs` as `type`, the messages have this class for type checkers:
        ``recording.messages("/odom", type=Odometry)``.

        Args:
            topics: Names of topics; without any, all topics with ROS messages of known types, or of
                `type`.
            type: Class or name of the message type.
            start: Time of the first message, s, or a stamp; None for the start of the recording.
            end: Time of the last message, s, or a stamp; None for the end of the recording.

        Raises:
            UnknownNameError: The recording does not contain a topic.
            GraphError: A topic has a different type, or `type` is not a message type.
            RecordingError: A topic does not contain ROS messages, its type is unknown, or the file
                is damaged.
        """
        decoders = {}
        wanted = [one for each in topics for one in self._found(each)]
        kind = None if type is None else name_of(type)
        for number, topic in wanted or enumerate(self._recording.topics):
            # ROS 2's types of a few packages, such as control_msgs, have another name in a world.
            if kind is not None and topic.type not in (kind, kind.replace("_ros2/", "/", 1)):
                if not topics:
                    continue
                raise GraphError(
                    f'the topic "{topic.name}" has the type {topic.type}, not {kind}',
                    code=TOPIC_TYPE_MISMATCH,
                    values={"topic": topic.name, "type": topic.type, "name": kind},
                )
            try:
                decoders[number] = (topic.name, decoder(topic))
            except RecordingError:
                if topics:
                    raise
        return self._messages(decoders, start, end)

    def _messages(
        self, decoders: dict[int, Any], start: Moment | None, end: Moment | None
    ) -> Iterator[RecordedMessage[Any]]:
        begin_ns = 0 if start is None else max(0, _moment_ns(start))
        end_ns = None if end is None else _moment_ns(end)
        for recorded in self._recording.messages(start_ns=begin_ns, topics=decoders.keys()):
            if end_ns is not None and recorded.time_ns > end_ns:
                return
            name, decode = decoders[recorded.number]
            yield RecordedMessage(recorded.time_ns / NANOSECONDS, name, decode(recorded.data))

    def times(self, topic: str) -> Array:
        """The times of all messages on a topic, s, shape (n,).

        Raises:
            UnknownNameError: The recording does not contain the topic.
        """
        numbers = {number for number, _ in self._found(topic)}
        found = [each.time_ns for each in self._recording.messages(topics=numbers)]
        return np.array(found, dtype=float) / NANOSECONDS

    def values(self, topic: str, field: str) -> Array:
        """One number or one array of each message on a topic.

        Args:
            topic: Name of the topic.
            field: As for `Topic.values`, such as ``pose.pose.position.x`` or ``ranges``.

        Returns:
            As for `Topic.values`: shape (n,), or (n, m) for an array.

        Raises:
            UnknownNameError: The recording does not contain the topic.
            GraphError: The type does not have the field, or the field is not a number or an array
                of numbers.
            RecordingError: As for `messages`.
        """
        return arrays.values((each.message for each in self.messages(topic)), field)

    def transform(self, target: str, source: str, time: Moment | None = None) -> Pose:
        """Pose of the frame `source` in the frame `target`, from the recorded transforms.

        The first call reads all messages on ``/tf`` and ``/tf_static``.

        Args:
            target: Name of a frame.
            source: Name of a frame.
            time: Time of the messages' stamps, s, or a stamp; None for the newest one at which all
                transforms between the two frames are known.

        Raises:
            UnknownNameError: A frame does not exist, or the recording contains no transforms.
            GraphError: The frames are not connected, or not at this time.
            RecordingError: As for `messages`.
        """
        moment = None if time is None else _moment_ns(time)
        return self._transforms.lookup(target, source, moment)

    @functools.cached_property
    def _transforms(self) -> TransformBuffer:
        buffer = TransformBuffer(None)
        present = [name for name in ("/tf", "/tf_static") if name in self.topics]
        for each in self.messages(*(present or ["/tf"])):
            buffer.add(each.message.transforms, static=each.topic == "/tf_static")
        return buffer

    def close(self) -> None:
        """Closes the file."""
        self._recording.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _found(self, name: str) -> list[tuple[int, RecordedTopic]]:
        """The numbers and entries of a topic, one for each type that it had."""
        found = [
            (number, each)
            for number, each in enumerate(self._recording.topics)
            if each.name == name and each.count
        ]
        if not found:
            raise UnknownNameError("topic", name, self.topics, code=TOPIC_UNKNOWN)
        return found

    def _span(self) -> tuple[int, int]:
        span = span_of(self._recording)
        if span is None:
            raise RecordingError(
                f'the recording "{self.path}" contains no messages', code=RECORDING_EMPTY
            )
        return span


def _moment_ns(time: Moment) -> int:
    """Times of recordings may be those of a real robot, such as 1.7e9 s."""
    if is_stamp(time):
        return nanoseconds(time)
    return round(scalar(time, "time") * NANOSECONDS)  # type: ignore[arg-type]
