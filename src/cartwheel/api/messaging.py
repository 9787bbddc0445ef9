"""Topics, message types and recordings of a world."""

from __future__ import annotations

import contextlib
import functools
import threading
from collections.abc import Callable, Iterator, Sequence
from operator import attrgetter
from pathlib import Path
from typing import TYPE_CHECKING, Any, overload

from cartwheel.api.arguments import refused, several, text
from cartwheel.api.timing import TimedWorld
from cartwheel.api.topics import Topic
from cartwheel.codes.graph import TOPIC_UNKNOWN
from cartwheel.codes.running import CONTROLLERS_NOT_NAMED
from cartwheel.errors import UnknownNameError
from cartwheel.graph import (
    CheckedPublisher,
    Graph,
    Mailbox,
    Subscription,
    absolute_name,
    made_message,
)
from cartwheel.messages.typed import Kind, M, name_of
from cartwheel.simulation.limits import check_size

if TYPE_CHECKING:
    from cartwheel.bridges.recording import Encoding, Recorder
    from cartwheel.session import Session


_TRANSFORMS = "tf2_msgs/msg/TFMessage"


class MessagingWorld(TimedWorld):
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
            GraphError: The message type does not have a given field, `message` is not a message of
                the topic's type, or both a message and fields are given.
        """
        self._check_open()
        with self._looking_up():
            kind = self.graph.topic(text(topic, "topic")).type
        self.graph.publish(topic, kind, made_message(topic, kind, message, fields))

    @property
    def topics(self) -> tuple[str, ...]:
        """Names of the topics with a publisher or a subscriber, sorted."""
        return tuple(info.name for info in self.graph.topics())

    @overload
    def topic(self, name: str, type: type[M], *, keep: int | None = None) -> Topic[M]: ...
    @overload
    def topic(
        self, name: str, type: str | None = None, *, keep: int | None = None
    ) -> Topic[Any]: ...
    def topic(self, name: str, type: Kind | None = None, *, keep: int | None = None) -> Topic[Any]:
        """Subscribes to a topic, and returns an object with its messages.

        With a class of `cartwheel.msgs` as `type`, the messages have this class for type checkers:
        ``world.topic("/odom", Odometry)``.

        A sensor without subscribers produces no data, so call the method before the run whose
        messages you need. Further calls with the same name return the same object.

        ``/robot_description``, in the namespace of a robot, contains its expanded XML. It is
        published from the first call on. So are the transforms of all links on ``/tf`` and
        ``/tf_static``, as robot_state_publisher does, but not while ROS 1 is connected, where
        another node publishes them.

        Args:
            name: Topic name.
            type: Class or name of the message type. Required if the topic does not exist yet.
            keep: Number of messages that `Topic.history` keeps; None for 1000, or 10 for images and
                point clouds.

        Raises:
            UnknownNameError: The topic does not exist and no type is given, or the type does not
                exist.
            SimulationError: The world is closed.
            GraphError: The topic has a different type, `type` is not a message type, or its
                definition is invalid.
            CartwheelError: `keep` is out of range.
        """
        self._check_open()
        full = self._full_name(text(name, "name"), type)
        if keep is not None:
            check_size(keep)
        self._describe(name)
        with self._used():
            found = self._known_topics.get(absolute_name(name))
            if found is None:
                with self._looking_up():
                    found = Topic(self, name, full, keep)
                self._known_topics[name] = self._known_topics[found.name] = found
            elif full is not None and full != found.type:
                # The graph refuses it, and names both types.
                self.graph.advertise(name, full).close()
        if keep is not None:
            found.keep(keep)
        return found

    def _full_name(self, topic: str, kind: Kind | None) -> str | None:
        """The name of a type that a program gives; None if it gives none."""
        if kind is None:
            return _TRANSFORMS if _has_transforms(text(topic, "topic")) else None
        return str(self.message_class(name_of(kind)).__msgtype__)

    def _describe(self, topic: str) -> None:
        """Publishes descriptions or transforms of the robots from now on, if a topic has these."""
        hold: Callable[[Session], object]
        name = topic.rpartition("/")[2]
        if name == "robot_description":
            from cartwheel.gazebo.robot_descriptions import hold_descriptions

            hold = hold_descriptions
        elif _has_transforms(topic):
            from cartwheel.gazebo.robot_states import hold_states

            name, hold = "tf", hold_states
        else:
            return
        session = self.session

        def describe() -> None:
            if name not in self._described:
                hold(session)
                self._described.add(name)
            session.update_robots()

        if self._run_by_another():
            session.simulation.post(describe)
        else:
            with self._used():
                describe()

    @functools.cached_property
    def _described(self) -> set[str]:
        """What the world itself publishes about its robots."""
        return set()

    @functools.cached_property
    def _known_topics(self) -> dict[str, Topic]:
        return {}

    def _end(self) -> None:
        self._known_topics.clear()
        super()._end()

    def _forget_topic(self, topic: Topic) -> None:
        for name in [name for name, each in self._known_topics.items() if each is topic]:
            del self._known_topics[name]

    @overload
    def subscribe(
        self, topic: str, callback: Callable[[M], object], *, type: type[M]
    ) -> Subscription: ...
    @overload
    def subscribe(
        self, topic: str, callback: Callable[[Any], object], *, type: str | None = None
    ) -> Subscription: ...
    def subscribe(
        self,
        topic: str,
        callback: Callable[[Any], object],
        *,
        type: Kind | None = None,
    ) -> Subscription:
        """Calls `callback` with each message during `run`.

        An exception in the callback stops `run` after the current step. The next `run` continues
        from there.

        Args:
            topic: Topic name.
            callback: Receives each message. It must not change the message.
            type: As for `topic`.

        Returns:
            The subscription; `close` ends it.

        Raises:
            UnknownNameError: The topic does not exist and no type is given, or the type does not
                exist.
            SimulationError: The world is closed.
            GraphError: As for `topic`.
        """
        self._check_open()
        text(topic, "topic")
        if not callable(callback):
            raise refused("callback", "a function", callback)
        simulation = self.session.simulation

        def guarded(message: Any) -> None:
            try:
                callback(message)
            except BaseException as error:  # noqa: BLE001 - raised by `run`
                simulation.faults.defer(error)

        full = self._full_name(topic, type)
        self._describe(topic)
        with self._looking_up():
            return self.graph.subscribe(topic, guarded, type_name=full)

    @overload
    def advertise(self, topic: str, type: type[M]) -> CheckedPublisher[M]: ...
    @overload
    def advertise(self, topic: str, type: str) -> CheckedPublisher[Any]: ...
    def advertise(self, topic: str, type: Kind) -> CheckedPublisher[Any]:
        """Advertises a topic, and returns its publisher.

        Its method `publish` accepts the same as `World.publish`, without the name of the topic.

        Args:
            topic: Topic name.
            type: A class of `cartwheel.msgs`, or a name such as ``geometry_msgs/msg/Twist``, also
                of a type that a package of the workspace defines.

        Raises:
            UnknownNameError: The type does not exist.
            SimulationError: The world is closed.
            GraphError: The topic exists with a different type, `type` is not a message type, or
                its definition is invalid.
        """
        self._check_open()
        full = str(self.message_class(name_of(type)).__msgtype__)
        publisher = self.graph.advertise(text(topic, "topic"), full, checked=True)
        assert isinstance(publisher, CheckedPublisher)
        return publisher

    def message_class(self, type: str) -> Any:
        """Returns the class of a message type: a dataclass with the message's fields.

        Args:
            type: ``geometry_msgs/msg/Twist``, or a type that a package of the workspace defines.

        Raises:
            UnknownNameError: The type does not exist.
            GraphError: The definition of the type is invalid.
        """
        return self.graph.types.message_class(name_of(type))

    @overload
    def mailbox(self, topic: str, type: type[M], *, size: int = 1000) -> Mailbox[M]: ...
    @overload
    def mailbox(self, topic: str, type: str | None = None, *, size: int = 1000) -> Mailbox[Any]: ...
    def mailbox(self, topic: str, type: Kind | None = None, *, size: int = 1000) -> Mailbox[Any]:
        """Buffers the topic's messages, to be read after `run`.

        `get` waits only if a different thread runs the world, by default for at most 30 s. In the
        thread that runs it, no message can arrive while `get` waits, so an empty mailbox returns
        None at once.

        Args:
            topic: Topic name.
            type: As for `topic`.
            size: Capacity in messages, at least 1. A full mailbox drops the oldest message.

        Raises:
            UnknownNameError: The topic does not exist and no type is given, or the type does not
                exist.
            SimulationError: The world is closed.
            GraphError: As for `topic`.
            CartwheelError: `size` is out of range.
        """
        self._check_open()
        check_size(size)
        full = self._full_name(topic, type)
        self._describe(text(topic, "topic"))
        foreign = self._run_by_another
        with self._looking_up():
            return self.graph.mailbox(topic, size=size, type_name=full, can_come=foreign)

    @contextlib.contextmanager
    def _looking_up(self) -> Iterator[None]:
        """Adds to the error for an unknown topic which robots lack their controllers."""
        try:
            yield
        except UnknownNameError as error:
            reports = (
                each for each in self.session.diagnostics if each.code is CONTROLLERS_NOT_NAMED
            )
            idle = tuple(dict.fromkeys(str(each.values["model"]) for each in reports))
            if error.code is TOPIC_UNKNOWN and idle and not error.values["meant"]:
                error.hint = (
                    f"{error.hint or ''} No controllers run for {', '.join(idle)}: see "
                    f"{CONTROLLERS_NOT_NAMED.number} in World.diagnostics."
                ).lstrip()
                error.values = {**error.values, "idle": idle}
            raise

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
        from cartwheel.gazebo.robot_states import hold_states

        if not isinstance(file, str | Path):
            raise refused("file", "a path", file)
        simulation = self.session.simulation
        recorder = Recorder(
            self.graph,
            file,
            time_ns=functools.partial(attrgetter("time_ns"), simulation.engine),
            topics=several(topics, "topics"),
            encoding=encoding,
            overwrite=overwrite,
            notes=self.session.notes,
            report=simulation.report,
        )
        release: Callable[[], None] | None = None
        try:
            with self.lock:
                release = hold_states(self.session)
                recorder.start()
                simulation.drain()
            try:
                yield recorder
            finally:
                recorder.close()
        finally:
            with self.lock:
                simulation.drain()
                if release is not None:
                    release()


def _has_transforms(topic: str) -> bool:
    return topic.lstrip("/") in ("tf", "tf_static")
