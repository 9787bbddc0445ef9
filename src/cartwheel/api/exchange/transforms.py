"""Transforms between the frames of a world, as tf2 looks them up."""

from __future__ import annotations

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

_TYPE = "tf2_msgs/msg/TFMessage"
_NODE = "World.transform"


class FramedWorld(MessagingWorld):
    """The part of `World` that looks up transforms."""

    _transforms: _Stored | None = None

    def transform(self, target: str | Link, source: str | Link, time: Moment | None = None) -> Pose:
        """Pose of the frame `source` in the frame `target`, as nodes know it from the transforms.

        It is what tf2's ``lookup_transform(target, source, time)`` returns: `Pose.apply` of the
        result transforms points from `source` to `target`. All transforms on ``/tf`` and
        ``/tf_static`` count, such as those of drives, of the links of robots, and of programs.
        Between two transforms, the pose is interpolated. For exact poses, use `Link.pose`.

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
                return stored.buffer.lookup(*frames, moment)
            except UnknownNameError as error:
                if elsewhere := self._unread_topics():
                    error.hint = (
                        f"Transforms on {', '.join(elsewhere)} are not read. Systems of gz-sim "
                        "publish on /tf with <tf_topic>/tf</tf_topic>."
                    )
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

    def _unread_topics(self) -> tuple[str, ...]:
        """Names of other topics with transforms than those that are read."""
        return tuple(
            each.name
            for each in self.graph.topics()
            if each.type == _TYPE and each.name not in ("/tf", "/tf_static")
        )

    def _stored(self) -> _Stored:
        if self._transforms is None:
            self._describe("/tf")
            self._transforms = _Stored(self.session)
        else:
            self.session.update_robots()
        return self._transforms

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
        for topic, callback in (("/tf", self._on_moving), ("/tf_static", self._on_static)):
            session.graph.subscribe(topic, callback, type_name=_TYPE, node=_NODE)
        static = session.graph.latched("/tf_static")
        if static is not None:
            self._on_static(static)
        self._add_links()
        session.simulation.on_reset.append(self._rewind)

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
