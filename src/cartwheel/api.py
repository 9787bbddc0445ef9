"""Robots in a few lines of Python: a world, what stands in it, and time."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any

from cartwheel import description as descriptions
from cartwheel.codes.world import SIMULATION_CLOSED
from cartwheel.description.model import RobotDescription, WorldDescription
from cartwheel.errors import Diagnostic, SimulationError
from cartwheel.geometry import Pose
from cartwheel.graph import Graph, Mailbox
from cartwheel.messages import from_dict, from_flat, type_name
from cartwheel.session import Session
from cartwheel.simulation.clock import NANOSECONDS, to_ns

if TYPE_CHECKING:
    from cartwheel.bridges.recording import Encoding, Recorder
    from cartwheel.simulation import Simulation


class Model:
    """A model in a world, by its name."""

    def __init__(self, world: World, name: str) -> None:
        self._world = world
        self.name = name

    @property
    def pose(self) -> Pose:
        """Where its root link is in the world."""
        with self._world.lock:
            self._world.session.simulation.refresh()
            return self._world.session.simulation.pose(self.name)

    @pose.setter
    def pose(self, pose: Pose) -> None:
        with self._world.used() as simulation:
            simulation.set_pose(self.name, pose)

    def joint(self, name: str) -> float:
        """Position of a joint in rad or m.

        Raises:
            UnknownNameError: There is no such joint.
        """
        with self._world.lock:
            return self._world.session.simulation.joint_position(self.name, name)

    def publish(self, topic: str, message: Any = None, **fields: Any) -> None:
        """`World.publish`."""
        self._world.publish(topic, message, **fields)

    def delete(self) -> None:
        """Takes it out of the world."""
        with self._world.used() as simulation:
            simulation.delete(self.name)


class World:
    """A simulation that steps when you call `run`.

    Threads may share a world: while one of them is in `run`, the calls of others wait. A forked
    process has a copy of its own, whose cameras work only if no image was drawn before the fork.

    Args:
        world: ``empty``, another shipped world, a file, or a description.
        seed: Of all noise: the same seed and commands give the same bits.
        strict: Every warning about a file is an error.
        lenient: Plugins that name what their model does not have are left out, and reported, as
            in `cartwheel run`; else `spawn` refuses the model.
        bridge: Files of ros_gz_bridge, whose names topics have.

    Raises:
        DescriptionError: The world's file cannot be used.
    """

    def __init__(
        self,
        world: str | Path | WorldDescription = "empty",
        *,
        seed: int = 0,
        strict: bool = False,
        lenient: bool = False,
        bridge: Sequence[str | Path] = (),
    ) -> None:
        if not isinstance(world, WorldDescription):
            world = descriptions.load_world(world)
        files = [Path(file) for file in bridge]
        self.session = Session(world, seed=seed, strict=strict, lenient=lenient, bridge=files)
        self.session.simulation.drain()  # this thread is the owner
        self.lock = threading.RLock()
        """Held while a thread uses the world."""
        self._running = False
        self._closing = False

    def __enter__(self) -> World:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    @contextlib.contextmanager
    def used(self) -> Iterator[Simulation]:
        """The simulation, for this thread alone meanwhile.

        Raises:
            SimulationError: The world is closed.
        """
        with self.lock:
            if self.session.simulation.closed:
                raise SimulationError("the world is closed", code=SIMULATION_CLOSED)
            yield self.session.simulation

    @property
    def graph(self) -> Graph:
        """Its topics and services."""
        return self.session.graph

    @property
    def time(self) -> float:
        """Simulated seconds."""
        return self.session.simulation.time_ns / NANOSECONDS

    @property
    def models(self) -> tuple[str, ...]:
        """Names of what stands in it."""
        return self.session.simulation.models

    @property
    def diagnostics(self) -> tuple[Diagnostic, ...]:
        """What was reported about the files."""
        return self.session.diagnostics

    def spawn(
        self,
        robot: str | Path | RobotDescription,
        *,
        name: str | None = None,
        x: float = 0.0,
        y: float = 0.0,
        z: float = 0.0,
        roll: float = 0.0,
        pitch: float = 0.0,
        yaw: float = 0.0,
        arguments: Mapping[str, str] | None = None,
        package_path: Sequence[Path] = (),
        controllers: Sequence[str | Path] = (),
    ) -> Model:
        """Puts a model in the world.

        Args:
            robot: A xacro, URDF or SDF file, or a description.
            name: In this world; the description's own when None.
            x: m, with y and z the place of its root link; its file's where all are zero.
            y: m.
            z: m.
            roll: rad, with pitch and yaw about the world's axes.
            pitch: rad.
            yaw: rad.
            arguments: Of the xacro file.
            package_path: Folders in which packages are looked for first.
            controllers: YAML files of ros_control or ros2_control: their controllers start.

        Raises:
            DescriptionError: The file cannot be used.
            WorldError: The name is taken, or the model cannot be built.
            PluginError: It has no manager of controllers, or their file makes no sense.
        """
        if not isinstance(robot, RobotDescription):
            robot = descriptions.load_robot(robot, arguments=arguments, package_path=package_path)
        given = any((x, y, z, roll, pitch, yaw))
        pose = Pose.from_xyz_rpy((x, y, z), (roll, pitch, yaw)) if given else None
        files = [Path(file) for file in controllers]
        with self.used():
            return Model(self, self.session.spawn(robot, name=name, pose=pose, controllers=files))

    def model(self, name: str) -> Model:
        """A model that stands in the world.

        Raises:
            UnknownNameError: There is none of that name.
        """
        with self.lock:
            self.session.simulation.pose(name)
        return Model(self, name)

    def run(self, seconds: float) -> None:
        """Lets simulated time go on, as fast as it can.

        Raises:
            SimulationError: The simulation diverged, or the world is closed.
        """
        with self.used() as simulation:
            outer, self._running = self._running, True
            try:
                simulation.advance(simulation.time_ns + to_ns(seconds))
            finally:
                self._running = outer
                if self._closing and not outer:
                    self.session.close()

    def publish(self, topic: str, message: Any = None, **fields: Any) -> None:
        """Publishes on a topic that exists.

        Args:
            topic: Its name.
            message: A message or a mapping of its fields; zeros without either.
            fields: Instead of it, its fields, nested ones joined by ``_``: ``linear_x=0.5``.

        Raises:
            UnknownNameError: There is no such topic.
            GraphError: A field that the type does not have.
        """
        kind = self.graph.topic(topic).type
        if fields:
            message = from_flat(kind, fields)
        elif message is None or isinstance(message, Mapping):
            message = from_dict(kind, message or {})
        self.graph.publish(topic, kind, message)

    def subscribe(
        self, topic: str, callback: Callable[[Any], None], *, type: str | None = None
    ) -> None:
        """Calls `callback` with each message, within `run`.

        What it raises ends that `run`, as soon as the step that has begun is made. The next one
        goes on from there.
        """
        simulation = self.session.simulation

        def guarded(message: Any) -> None:
            try:
                callback(message)
            except BaseException as error:  # noqa: BLE001 - raised by `run`
                simulation.defer(error)

        self.graph.subscribe(topic, guarded, type_name=type_name(type) if type else None)

    def mailbox(self, topic: str, *, size: int = 1000) -> Mailbox:
        """Keeps the topic's messages to be read after `run`.

        Its `get` waits only where another thread runs the world: in the thread that does, no
        message comes while it waits, so that an empty mailbox gives None at once.
        """
        return self.graph.mailbox(topic, size=size, can_come=self._run_by_another)

    def _run_by_another(self) -> bool:
        """Whether another thread that still lives ran the world last."""
        owner = self.session.simulation.owner
        return owner != threading.get_ident() and any(
            thread.ident == owner for thread in threading.enumerate()
        )

    @contextlib.contextmanager
    def record(
        self,
        file: str | Path,
        *,
        topics: Sequence[str] = (),
        encoding: Encoding | None = None,
        overwrite: bool = False,
    ) -> Iterator[Recorder]:
        """Records what is published within a ``with`` block.

        Args:
            file: ``.mcap``, ``.bag``, ``.db3``, or a folder for a ROS 2 bag.
            topics: Patterns such as ``/camera/*``, ``re:/imu|/odom``, ``!/tf``; all where empty.
            encoding: Of the messages in a ``.mcap``: ``ros2`` or ``ros1``.
            overwrite: Replace what is there.

        Raises:
            RecordingError: It cannot be written; at the end also where it broke off.
        """
        from cartwheel.bridges.recording import Recorder
        from cartwheel.plugins.robot_descriptions import RobotDescriptions

        simulation = self.session.simulation
        recorder = Recorder(
            self.graph,
            file,
            time_ns=lambda: simulation.time_ns,
            topics=topics,
            encoding=encoding,
            overwrite=overwrite,
            notes=self.session.notes,
            report=simulation.report,
        )
        robots = RobotDescriptions(simulation, self.graph)
        try:
            recorder.start()
            simulation.drain()
            try:
                yield recorder
            finally:
                recorder.close()
        finally:
            simulation.drain()
            robots.close()

    def reset(self) -> None:
        """Takes time and every model back to the start."""
        with self.used() as simulation:
            simulation.reset()

    def close(self) -> None:
        """Ends the run and all topics; what was simulated can still be read.

        Called within `run`, it ends that run first. The memory is freed with the last reference
        to the world.
        """
        with self.lock:
            if self._running:
                self._closing = True
                self.session.simulation.stop()
            else:
                self.session.close()


__all__ = ["Model", "World"]
