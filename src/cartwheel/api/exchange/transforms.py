"""Transforms between the frames of a world, as tf2 looks them up."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from cartwheel.api.arguments import refused
from cartwheel.api.messaging import MessagingWorld
from cartwheel.api.values import Moment, moment_ns, scalar
from cartwheel.errors import UnknownNameError
from cartwheel.gazebo.robot_states import RobotStates
from cartwheel.graph import resolve_frame
from cartwheel.graph.transform_buffer import KEPT_NS, SECOND, TransformBuffer
from cartwheel.simulation.limits import duration_ns

if TYPE_CHECKING:
    from cartwheel.api.links import Link
    from cartwheel.geometry import Pose
    from cartwheel.session import Session
    from cartwheel.simulation.models.resident import Resident

_TYPE = "tf2_msgs/msg/TFMessage"
_NODE = "World.transform"


class FramedWorld(MessagingWorld):
    """The part of `World` that looks up transforms."""

    _transforms: _Stored | None = None

    def transform(self, target: str | Link, source: str | Link, time: Moment | None = None) -> Pose:
        """Pose of the frame `source` in the frame `target`, as nodes know it from the transforms.

        It is what tf2's ``lookup_transform(target, source, time)`` returns: `Pose.apply` of the
        result transforms points from `source` to `target`. All transforms on ``/tf`` and
        ``/tf_static`` count, such as those of drives, of the links of robots, and of programs, and
        those of odometry on other topics, such as ``/model/rover/tf``. Between two transforms, the
        pose is interpolated. For exact poses, use `Link.pose`.

        Transforms are stored from the first call of this method, `frames` or `keep_transforms` on.
        At this call, the poses of a robot's links in each other are known at once, and other
        frames when they are published during a run.

        Args:
            target: Name of a frame, or a link.
            source: Name of a frame, or a link.
            time: Simulation time, s, or the stamp of a message; None for the newest time at which
                all transforms between the two frames are known.

        Raises:
            UnknownNameError: A frame does not exist.
            GraphError: The frames are not connected, or the time is later than the newest
                transform, or earlier than the oldest one.
            SimulationError: The world is closed.
        """
        moment = None if time is None else moment_ns(time)
        with self._used():
            frames = self._frame(target, "target"), self._frame(source, "source")
            stored = self._stored()
            try:
                return stored.buffer.lookup(*frames, moment, named=stored.named)
            except UnknownNameError as error:
                if not error.values["meant"] and (elsewhere := self._unread_topics(stored)):
                    error.hint = (
                        f"{error.hint or ''} Transforms on {', '.join(elsewhere)} are not read."
                    ).lstrip()
                    error.values = {**error.values, "elsewhere": elsewhere}
                raise

    @property
    def frames(self) -> tuple[str, ...]:
        """Names of the frames of all transforms that are stored, sorted; see `transform`."""
        with self._used():
            return tuple(self._stored().buffer.frames)

    def keep_transforms(self, seconds: float = KEPT_NS / SECOND) -> None:
        """Stores transforms from now on, for `transform`.

        Args:
            seconds: Simulation time for which at least they are stored, s.

        Raises:
            CartwheelError: `seconds` is not above 0.
            SimulationError: The world is closed.
        """
        scalar(seconds, "seconds", above=0.0)
        with self._used():
            buffer = self._stored().buffer
            buffer.kept_ns = max(buffer.kept_ns, duration_ns(seconds))

    def _frame(self, frame: str | Link, name: str) -> str:
        """The name of a frame that a program gives."""
        from cartwheel.api.links import Link

        if isinstance(frame, Link):
            simulation = self.session.simulation
            simulation.truth.link(frame.model, frame.name)
            return resolve_frame(frame.name, simulation.frame_prefix(frame.model))
        if not isinstance(frame, str):
            raise refused(name, "the name of a frame or a Link", frame)
        return frame

    def _unread_topics(self, stored: _Stored) -> tuple[str, ...]:
        """Names of other topics with transforms than those that are read."""
        return tuple(
            each.name
            for each in self.graph.topics()
            if each.type == _TYPE and each.name not in stored.topics
        )

    def _stored(self) -> _Stored:
        if self._transforms is None:
            self._describe("/tf")
            self._transforms = _Stored(self.session)
        else:
            self.session.update_robots()
            self._transforms.follow()
        return self._transforms

    def _begin(self) -> int | None:
        outer = super()._begin()
        if self._transforms is not None:
            self._transforms.follow()
        return outer

    def _end(self) -> None:
        self._transforms = None
        super()._end()


class _Stored:
    """Stores the transforms of a session, without a reference to the world, which would be a cycle.

    Args:
        session: The session.
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._rewinds = session.simulation.engine.rewinds
        self.buffer = TransformBuffer(session.simulation.time_ns)
        self.topics: set[str] = set()
        """Names of the topics that are read."""
        self._residents: list[Resident] = []
        for topic, callback in (("/tf", self._on_moving), ("/tf_static", self._on_static)):
            self._read(topic, callback)
        self.follow()
        static = session.graph.latched("/tf_static")
        if static is not None:
            self._on_static(static)
        self._add_links()
        session.simulation.on_reset.append(self._rewind)

    def _read(self, topic: str, callback: Callable[[Any], None]) -> None:
        self._session.graph.subscribe(topic, callback, type_name=_TYPE, node=_NODE)
        self.topics.add(topic)

    def follow(self) -> None:
        """Reads the topics on which new robots publish the transform of their odometry."""
        residents = list(self._session.simulation.population.residents.values())
        if residents == self._residents:
            return
        self._residents = residents
        for resident in residents:
            for topic in sorted(resident.part.transformed - self.topics):
                self._read(topic, self._on_odometry)

    def named(self, frame: str) -> str:
        """The frame of a link on ``/tf``, for its name in gz-sim: ``model/link``."""
        name, _, link = frame.partition("/")
        resident = self._session.simulation.population.residents.get(name)
        if resident is None or resident.entry.description.link(link) is None:
            return frame
        return resolve_frame(link, resident.part.frame_prefix)

    def _on_odometry(self, message: Any) -> None:
        self._forget()
        self.buffer.add(message.transforms, static=False, named=self.named)

    def _on_moving(self, message: Any) -> None:
        self._forget()
        self.buffer.add(message.transforms, static=False)

    def _on_static(self, message: Any) -> None:
        self._forget()
        self.buffer.add(message.transforms, static=True)

    def _rewind(self) -> None:
        """Forgets transforms of the future after time was set."""
        self._forget()
        self._add_links()

    def _forget(self) -> None:
        simulation = self._session.simulation
        if self._rewinds != simulation.engine.rewinds:
            self._rewinds = simulation.engine.rewinds
            self.buffer.rewind(simulation.time_ns)

    def _add_links(self) -> None:
        """Adds the current poses of the links, without a message."""
        states = self._session.states
        if isinstance(states, RobotStates):
            self.buffer.add(states.transforms(every=True), static=False)
