"""The Python API: worlds, models and simulation time."""

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
    """A handle to a model in a world."""

    def __init__(self, world: World, name: str) -> None:
        self._world = world
        self.name = name

    @property
    def pose(self) -> Pose:
        """Pose of the root link in the world frame."""
        with self._world.lock:
            self._world.session.simulation.refresh()
            return self._world.session.simulation.pose(self.name)

    @pose.setter
    def pose(self, pose: Pose) -> None:
        with self._world.used() as simulation:
            simulation.set_pose(self.name, pose)

    def joint(self, name: str) -> float:
        """Position of a joint, rad or m.

        Raises:
            UnknownNameError: The joint does not exist.
        """
        with self._world.lock:
            return self._world.session.simulation.joint_position(self.name, name)

    def publish(self, topic: str, message: Any = None, **fields: Any) -> None:
        """`World.publish`."""
        self._world.publish(topic, message, **fields)

    def delete(self) -> None:
        """Removes the model from the world."""
        with self._world.used() as simulation:
            simulation.delete(self.name)


class World:
    """A simulation that advances when you call `run`.

    Several threads can share a world: while one thread is in `run`, calls from other threads wait.
    A forked process has its own copy. Its cameras work only if no image was rendered before the
    fork.

    Args:
        world: ``empty``, the name of another built-in world, a file, or a description.
        seed: Seed for all noise. The same seed and commands give identical results.
        strict: Treat every warning about a file as an error.
        lenient: Skip plugins that refer to missing parts of their model and report a warning, as in
            `cartwheel run`. Otherwise `spawn` raises an error.
        bridge: Configuration files of ros_gz_bridge, which define topic names.
        plugins: Python files that define plugins. They are executed.

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
        plugins: Sequence[str | Path] = (),
    ) -> None:
        if not isinstance(world, WorldDescription):
            world = descriptions.load_world(world)
        files = [Path(file) for file in bridge]
        self.session = Session(
            world,
            seed=seed,
            strict=strict,
            lenient=lenient,
            bridge=files,
            plugins=[Path(file) for file in plugins],
        )
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
        """Exclusive access to the simulation for this thread.

        Raises:
            SimulationError: The world is closed.
        """
        with self.lock:
            if self.session.simulation.closed:
                raise SimulationError("the world is closed", code=SIMULATION_CLOSED)
            yield self.session.simulation

    @property
    def graph(self) -> Graph:
        """The world's topics and services."""
        return self.session.graph

    @property
    def time(self) -> float:
        """Simulation time, s."""
        return self.session.simulation.time_ns / NANOSECONDS

    @property
    def models(self) -> tuple[str, ...]:
        """Names of the models in the world."""
        return self.session.simulation.models

    @property
    def diagnostics(self) -> tuple[Diagnostic, ...]:
        """Diagnostics reported so far."""
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
        """Spawns a model.

        Args:
            robot: A xacro, URDF or SDF file, or a description.
            name: Name in this world; None for the description's name.
            x: x coordinate of the root link, m. The file's pose is used if all values are zero.
            y: y coordinate, m.
            z: z coordinate, m.
            roll: Rotation about the world's x axis, rad.
            pitch: Rotation about the world's y axis, rad.
            yaw: Rotation about the world's z axis, rad.
            arguments: Arguments of the xacro file.
            package_path: Folders to search for packages first.
            controllers: YAML files for ros_control or ros2_control, whose controllers are started.

        Raises:
            DescriptionError: The file cannot be used.
            WorldError: The name is in use, or the model cannot be built.
            PluginError: A plugin cannot be used, the model has no controller manager, or a
                controller file is invalid.
        """
        if not isinstance(robot, RobotDescription):
            robot = descriptions.load_robot(robot, arguments=arguments, package_path=package_path)
        given = any((x, y, z, roll, pitch, yaw))
        pose = Pose.from_xyz_rpy((x, y, z), (roll, pitch, yaw)) if given else None
        files = [Path(file) for file in controllers]
        with self.used():
            return Model(self, self.session.spawn(robot, name=name, pose=pose, controllers=files))

    def model(self, name: str) -> Model:
        """Returns a handle to a model in the world.

        Raises:
            UnknownNameError: No model has this name.
        """
        with self.lock:
            self.session.simulation.pose(name)
        return Model(self, name)

    def run(self, seconds: float) -> None:
        """Advances the simulation as fast as possible.

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
        """Publishes a message on an existing topic.

        Args:
            topic: Topic name.
            message: A message or a mapping of its fields. The default message contains zeros.
            fields: The fields instead of `message`. Join nested names with ``_``: ``linear_x=0.5``.

        Raises:
            UnknownNameError: The topic does not exist.
            GraphError: The message type does not have a given field.
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
        """Calls `callback` with each message during `run`.

        An exception in the callback stops `run` after the current step. The next `run` continues
        from there.
        """
        simulation = self.session.simulation

        def guarded(message: Any) -> None:
            try:
                callback(message)
            except BaseException as error:  # noqa: BLE001 - raised by `run`
                simulation.defer(error)

        self.graph.subscribe(topic, guarded, type_name=type_name(type) if type else None)

    def mailbox(self, topic: str, *, size: int = 1000) -> Mailbox:
        """Buffers the topic's messages, to be read after `run`.

        `get` waits only if a different thread runs the world. In the thread that runs it, no
        message can arrive while `get` waits, so an empty mailbox returns None at once.
        """
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
        topics: Sequence[str] = (),
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
        """Resets simulation time and all models to their initial state."""
        with self.used() as simulation:
            simulation.reset()

    def close(self) -> None:
        """Stops the simulation and closes all topics; recorded values stay readable.

        When called within `run`, it stops that run first. The memory is freed with the last
        reference to the world.
        """
        with self.lock:
            if self._running:
                self._closing = True
                self.session.simulation.stop()
            else:
                self.session.close()


__all__ = ["Model", "World"]
