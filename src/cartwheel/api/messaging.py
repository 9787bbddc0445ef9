"""Topics, message types and recordings of a world."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from cartwheel.api.running import RunningWorld
from cartwheel.graph import Graph, Mailbox, Publisher, check_message
from cartwheel.messages import from_dict, from_flat
from cartwheel.simulation.limits import check_size

if TYPE_CHECKING:
    from cartwheel.bridges.recording import Encoding, Recorder

T = TypeVar("T", bound=str | Path)


class MessagingWorld(RunningWorld):
    """The part of `World` that publishes, receives and records messages."""

    @property
    def graph(self) -> Graph:
        """The world's topics and services."""
        self.lock.check()
        return self.session.graph

    def publish(self, topic: str, message: Any = None, **fields: Any) -> None:
        """Publishes a message on an existing topic.

        Args:
            topic: Topic name.
            message: A message or a mapping of its fields. The default message contains zeros.
            fields: The fields instead of `message`. Join nested names with ``_``: ``linear_x=0.5``.

        Raises:
            UnknownNameError: The topic does not exist.
            SimulationError: The world is closed.
            GraphError: The message type does not have a given field, or `message` is not a message
                of the topic's type.
        """
        self.check_open()
        kind = self.graph.topic(topic).type
        if fields:
            message = from_flat(kind, fields)
        elif message is None or isinstance(message, Mapping):
            message = from_dict(kind, message or {})
        else:
            check_message(topic, kind, message)
        self.graph.publish(topic, kind, message)

    def subscribe(
        self, topic: str, callback: Callable[[Any], None], *, type: str | None = None
    ) -> None:
        """Calls `callback` with each message during `run`.

        An exception in the callback stops `run` after the current step. The next `run` continues
        from there.

        Args:
            topic: Topic name.
            callback: Receives each message. It must not change the message.
            type: As in `advertise`. Required if the topic does not exist yet.

        Raises:
            UnknownNameError: The topic does not exist and no type is given, or the type does not
                exist.
            SimulationError: The world is closed.
            GraphError: The topic has a different type, or the definition of the type is invalid.
        """
        self.check_open()
        simulation = self.session.simulation

        def guarded(message: Any) -> None:
            try:
                callback(message)
            except BaseException as error:  # noqa: BLE001 - raised by `run`
                simulation.faults.defer(error)

        full = None if type is None else self.message_class(type).__msgtype__
        self.graph.subscribe(topic, guarded, type_name=full)

    def advertise(self, topic: str, type: str) -> Publisher:
        """Advertises a topic, and returns its publisher.

        `Publisher.publish` raises a `GraphError` for a value that is not a message of the type.

        Args:
            topic: Topic name.
            type: ``geometry_msgs/msg/Twist``, or a type that a package of the workspace defines.

        Raises:
            UnknownNameError: The type does not exist.
            SimulationError: The world is closed.
            GraphError: The topic exists with a different type, or the definition of the type is
                invalid.
        """
        self.check_open()
        full = self.message_class(type).__msgtype__
        return self.graph.advertise(topic, full, checked=True)

    def message_class(self, type: str) -> Any:
        """Returns the class of a message type: a dataclass with the message's fields.

        Args:
            type: ``geometry_msgs/msg/Twist``, or a type that a package of the workspace defines.

        Raises:
            UnknownNameError: The type does not exist.
            GraphError: The definition of the type is invalid.
        """
        return self.graph.types.message_class(str(type))

    def mailbox(self, topic: str, *, size: int = 1000) -> Mailbox:
        """Buffers the topic's messages, to be read after `run`.

        `get` waits only if a different thread runs the world. In the thread that runs it, no
        message can arrive while `get` waits, so an empty mailbox returns None at once.

        Args:
            topic: Name of an existing topic.
            size: Capacity in messages, at least 1. A full mailbox drops the oldest message.

        Raises:
            UnknownNameError: The topic does not exist.
            SimulationError: The world is closed.
            CartwheelError: `size` is out of range.
        """
        self.check_open()
        check_size(size)
        return self.graph.mailbox(topic, size=size, can_come=self._run_by_another)

    def _run_by_another(self) -> bool:
        """Whether a different thread ran the world last and is still alive."""
        owner = self.session.simulation.owner
        return owner != threading.get_ident() and any(
            thread.ident == owner for thread in threading.enumerate()
        )

    @contextlib.contextmanager
    def record(
        self,
        file: str | Path,
        *,
        topics: str | Sequence[str] = (),
        encoding: Encoding | None = None,
        overwrite: bool = False,
    ) -> Iterator[Recorder]:
        """Records messages within a ``with`` block.

        Args:
            file: ``.mcap``, ``.bag``, ``.db3``, or a folder for a ROS 2 bag.
            topics: Patterns such as ``/camera/*``, ``re:/imu|/odom``, ``!/tf``; empty for all
                topics.
            encoding: Message encoding in ``.mcap`` files: ``ros2`` or ``ros1``.
            overwrite: Replace an existing file.

        Raises:
            RecordingError: The file cannot be written. Failures during the recording are raised
                when the block ends.
        """
        from cartwheel.bridges.recording import Recorder
        from cartwheel.gazebo.robot_descriptions import RobotDescriptions

        simulation = self.session.simulation
        recorder = Recorder(
            self.graph,
            file,
            time_ns=lambda: simulation.time_ns,
            topics=several(topics),
            encoding=encoding,
            overwrite=overwrite,
            notes=self.session.notes,
            report=simulation.report,
        )
        robots = None
        try:
            with self.lock:
                if self._connections is None or not self._connections.assembly.describes_robots:
                    robots = RobotDescriptions(simulation, self.graph)
                recorder.start()
                simulation.drain()
            try:
                yield recorder
            finally:
                recorder.close()
        finally:
            with self.lock:
                simulation.drain()
                if robots is not None:
                    robots.close()


def several(values: T | Sequence[T]) -> list[T]:
    """The items of a sequence. A single text or path is one item, not a sequence of characters."""
    return [values] if isinstance(values, str | Path) else list(values)
