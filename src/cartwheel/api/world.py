"""A world that a program runs."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, TypeVar

from cartwheel import description as descriptions
from cartwheel.api.model import Model
from cartwheel.api.running import RunningWorld
from cartwheel.description.model import RobotDescription, WorldDescription
from cartwheel.errors import Diagnostic
from cartwheel.geometry import Pose
from cartwheel.graph import Graph, Mailbox, Publisher, check_message
from cartwheel.messages import from_dict, from_flat
from cartwheel.session import Session
from cartwheel.simulation.clock import NANOSECONDS
from cartwheel.simulation.limits import check_size

if TYPE_CHECKING:
    from cartwheel.bridges.recording import Encoding, Recorder

T = TypeVar("T", bound=str | Path)


class World(RunningWorld):
    """A simulation that advances when you call `run` or `spin`.

    Several threads can share a world: while one thread is in `run`, calls from other threads wait.
    A forked process has its own copy of a world without connections. Its cameras work only if no
    image was rendered before the fork. A world with connections raises a `SimulationError` there.

    Args:
        world: ``empty``, the name of another built-in world, a file, or a description.
        seed: Seed for all noise. The same seed and commands give identical results.
        strict: Treat every warning about a file as an error.
        lenient: Skip plugins that cannot be created, for example because a parameter is invalid,
            and report an error, as in `cartwheel run`. Otherwise the model is rejected.
        bridge: Configuration files of ros_gz_bridge, which define topic names.
        plugins: Python files that define plugins. They are executed.
        ros1: Connect to ROS 1; a text is the node's name.
        ros2: Connect to ROS 2; a text is the node's name.
        rmw: Middleware of ROS 2: ``dds`` or ``zenoh``.
        foxglove: Start a server for Foxglove; a number is its port.
        viewer: Start the web interface; a number is its port.
        record: Files or folders in which messages are recorded until `close`.
        record_topics: Patterns of the recorded topics; empty for all topics.
        overwrite: Replace existing recordings.
        allow_path: Folders with files that clients may load.
        host: Address on which the web interface and the Foxglove server listen.
        allow_origin: Origins of further web pages that may connect to them.
        package_path: Folders to search for the packages of message types first.
        without: Physics that Cartwheel adds to descriptions and that is to be omitted:
            ``chain-drag``, ``round-tyres``, ``soft-sliding``, ``limited-friction``,
            ``minimum-inertia``, ``raised-efforts``, ``slow-separation`` or ``all``.

    Raises:
        DescriptionError: The world's file cannot be used.
        CartwheelError: A name in `without` is unknown, or a connection cannot be opened. Nothing
            remains open.
    """

    def __init__(
        self,
        world: str | Path | WorldDescription = "empty",
        *,
        seed: int = 0,
        strict: bool = False,
        lenient: bool = False,
        bridge: str | Path | Sequence[str | Path] = (),
        plugins: str | Path | Sequence[str | Path] = (),
        ros1: bool | str = False,
        ros2: bool | str = False,
        rmw: Literal["dds", "zenoh"] = "dds",
        foxglove: bool | int = False,
        viewer: bool | int = False,
        record: str | Path | Sequence[str | Path] = (),
        record_topics: str | Sequence[str] = (),
        overwrite: bool = False,
        allow_path: str | Path | Sequence[str | Path] = (),
        package_path: str | Path | Sequence[str | Path] = (),
        host: str = "127.0.0.1",
        allow_origin: str | Sequence[str] = (),
        without: str | Sequence[str] = (),
    ) -> None:
        connections = plan = None
        files = _several(record)
        # A port may be 0, which selects a free port.
        if ros1 or ros2 or foxglove is not False or viewer is not False or files:
            from cartwheel.assembly.connections import FOXGLOVE_PORT, NODE, Connections, port
            from cartwheel.assembly.plan import Plan
            from cartwheel.assembly.recording import RecordingOptions

            plan = Plan(
                ros1=NODE if ros1 is True else ros1 or None,
                ros2=NODE if ros2 is True else ros2 or None,
                rmw=rmw,
                foxglove=port(foxglove, FOXGLOVE_PORT),
                viewer=viewer is not False,
                viewer_port=port(viewer, None),
                recordings=tuple(Path(file) for file in files),
                recording=RecordingOptions(
                    topics=tuple(_several(record_topics)), overwrite=overwrite
                ),
            )
            connections = Connections(host=host, allow_origin=_several(allow_origin))
        session: Session | None = None
        try:
            if connections is not None and plan is not None:
                connections.prepare(plan)
            if not isinstance(world, WorldDescription):
                world = descriptions.load_world(world)
            session = Session(
                world,
                seed=seed,
                strict=strict,
                lenient=lenient,
                bridge=[Path(file) for file in _several(bridge)],
                allow_path=[Path(folder) for folder in _several(allow_path)],
                plugins=[Path(file) for file in _several(plugins)],
                package_path=[Path(folder) for folder in _several(package_path)],
                without=_several(without),
            )
            super().__init__(
                session,
                host=host,
                allow_origin=_several(allow_origin),
                connections=connections,
                plan=plan,
            )
        except BaseException:
            if connections is not None:
                connections.close()
            if session is not None:
                session.close()
            raise

    @property
    def graph(self) -> Graph:
        """The world's topics and services."""
        self.lock.check()
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
        package_path: str | Path | Sequence[str | Path] = (),
        controllers: str | Path | Sequence[str | Path] = (),
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
        folders = [Path(folder) for folder in _several(package_path)]
        if not isinstance(robot, RobotDescription):
            robot = descriptions.load_robot(
                robot,
                arguments=arguments,
                package_path=folders,
            )
        given = any((x, y, z, roll, pitch, yaw))
        pose = Pose.from_xyz_rpy((x, y, z), (roll, pitch, yaw)) if given else None
        files = [Path(file) for file in _several(controllers)]
        with self.used(change=True):
            spawned = self.session.spawn(
                robot, name=name, pose=pose, controllers=files, package_path=folders
            )
            return Model(self, spawned)

    def model(self, name: str) -> Model:
        """Returns a handle to a model in the world.

        Raises:
            UnknownNameError: No model has this name.
        """
        with self.lock:
            self.session.simulation.pose(name)
        return Model(self, name)

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
            topics=_several(topics),
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

    def reset(self) -> None:
        """Resets simulation time and all models to their initial state."""
        with self.used(change=True) as simulation:
            simulation.reset()


def _several(values: T | Sequence[T]) -> list[T]:
    """The items of a sequence. A single text or path is one item, not a sequence of characters."""
    return [values] if isinstance(values, str | Path) else list(values)
