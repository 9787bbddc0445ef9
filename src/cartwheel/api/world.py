"""A world that a program runs."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Never, Self, SupportsFloat

from cartwheel import description as descriptions
from cartwheel.api.arguments import (
    bridges,
    check_xacro_arguments,
    paths,
    refused,
    several,
    source,
    text,
    xacro_arguments,
)
from cartwheel.api.basis import Basis
from cartwheel.api.calling import CallingWorld
from cartwheel.api.handles import unknown_attribute
from cartwheel.api.model import Model
from cartwheel.api.pictures import PicturedWorld
from cartwheel.api.saving import SavingWorld
from cartwheel.api.surroundings.surroundings import SurroundingWorld
from cartwheel.api.values import instance, invalid, scalar
from cartwheel.codes import codes_matching
from cartwheel.codes.command import OPTION_INVALID, OPTIONS_CONFLICT
from cartwheel.description.model import RobotDescription, WorldDescription
from cartwheel.description.sdf.worlds.world import LONGEST_STEP, SHORTEST_STEP
from cartwheel.errors import CartwheelError, Code, Diagnostic
from cartwheel.geometry import Pose
from cartwheel.graph import resolve_name
from cartwheel.session import Session
from cartwheel.simulation.clock import NANOSECONDS
from cartwheel.simulation.limits import check_seed, number
from cartwheel.simulation.models.unique_names import check_model_name
from cartwheel.watchers import announce


class World(SurroundingWorld, PicturedWorld, SavingWorld, CallingWorld):
    """A simulation that advances when you call `run` or `spin`.

    Several threads can share a world: while one thread is in `run`, calls from other threads wait.
    A forked process has its own copy of a world without connections. Its cameras work only if no
    image was rendered before the fork. A world with connections raises a `SimulationError` there.

    Args:
        world: ``empty``, the name of another built-in world, a file, the XML of one as text, or a
            description.
        seed: Seed for all noise. The same seed and commands give identical results.
        strict: Treat every warning about a file as an error.
        ignore: Codes that are not in `diagnostics`, and are no errors with `strict`: numbers, names
            or prefixes such as ``CW2``, as for ``cartwheel check --ignore``.
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
            ``minimum-inertia``, ``raised-efforts``, ``slow-separation``, ``apart-hulls`` or
            ``all``.
        step_size: Time step of the physics, s; None for that of the world's file, or 0.005 s.

    Raises:
        DescriptionError: The world's file cannot be used.
        CartwheelError: A name in `without` or a code is unknown, or a connection cannot be opened.
            Nothing remains open.
    """

    _made = False
    """Whether the constructor has set all attributes."""
    _basis = Basis()

    @classmethod
    def _based(cls, basis: Basis, /, world: WorldDescription, **options: Any) -> Self:
        """Makes a world with what others share with it.

        Args:
            basis: What it has in common with others.
            world: See the class.
            options: Those of the class.
        """
        made = cls.__new__(cls)
        made._basis = basis
        cls.__init__(made, world, **options)
        return made

    def __init__(
        self,
        world: str | Path | WorldDescription = "empty",
        *,
        seed: int = 0,
        strict: bool = False,
        ignore: str | Sequence[str] = (),
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
        step_size: float | None = None,
    ) -> None:
        source(world, "world")
        check_seed(-1 if seed is None else seed)
        for name, flag in (("strict", strict), ("lenient", lenient), ("overwrite", overwrite)):
            if not isinstance(flag, bool):
                raise refused(name, "True or False", flag)
        for name, port_given in (("foxglove", foxglove), ("viewer", viewer)):
            if not isinstance(port_given, int):
                raise refused(name, "True, False or a port", port_given)
        self._ignored = frozenset[Code]().union(*map(codes_matching, several(ignore, "ignore")))
        connections = plan = None
        files = paths(record, "record")
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
                recordings=tuple(files),
                recording=RecordingOptions(
                    topics=tuple(several(record_topics, "record_topics")), overwrite=overwrite
                ),
            )
            connections = Connections(host=host, allow_origin=several(allow_origin, "allow_origin"))
        session: Session | None = None
        try:
            if connections is not None and plan is not None:
                connections.prepare(plan)
            if not isinstance(world, WorldDescription):
                world = descriptions.load_world(world)
            world = _with_step(world, step_size)
            session = Session(
                world,
                seed=seed,
                strict=strict,
                lenient=lenient,
                bridge=bridges(bridge),
                allow_path=paths(allow_path, "allow_path"),
                plugins=paths(plugins, "plugins"),
                package_path=paths(package_path, "package_path"),
                without=several(without, "without"),
                compiler=self._basis.compiler,
                readings=self._basis.readings,
                ignore=self._ignored,
            )
            super().__init__(
                session,
                host=host,
                allow_origin=several(allow_origin, "allow_origin"),
                connections=connections,
                plan=plan,
            )
            if self._basis.watched:
                announce(self)
        except BaseException:
            if connections is not None:
                connections.close()
            if session is not None:
                session.close()
            raise
        self._made = True

    def __repr__(self) -> str:
        if not self._made:
            return object.__repr__(self)
        simulation = self.session.simulation
        state = "closed" if simulation.closed else f"at {simulation.time_ns / 1e9:g} s"
        return f"<World {simulation.world.name!r} {state}>"

    if not TYPE_CHECKING:  # a type checker would accept any name

        def __setattr__(self, name: str, value: object) -> None:
            # Subclasses of programs may have attributes of their own.
            if (
                self._made
                and type(self) is World
                and not name.startswith("_")
                and name not in self.__dict__
                and not hasattr(World, name)
            ):
                raise unknown_attribute(self, name, also=("pace",))
            super().__setattr__(name, value)

    def __reduce__(self) -> Never:
        raise CartwheelError(
            "a world cannot be pickled or copied",
            code=OPTION_INVALID,
            hint="Pickle its state, which World.save returns, or the result of cartwheel.build, "
            "which makes worlds.",
            values={"name": "world"},
        )

    @property
    def time(self) -> float:
        """Simulation time, s."""
        return self.session.simulation.time_ns / NANOSECONDS

    @property
    def models(self) -> tuple[str, ...]:
        """Names of the models in the world."""
        return self.session.simulation.models

    @property
    def cameras(self) -> tuple[str, ...]:
        """Names of the cameras of all models, such as ``rosbots::camera1``; see `Model.cameras`."""
        with self.lock:
            return tuple(each for name in self.models for each in Model(self, name).cameras)

    @property
    def diagnostics(self) -> tuple[Diagnostic, ...]:
        """Diagnostics reported so far."""
        return tuple(each for each in self.session.diagnostics if each.code not in self._ignored)

    def spawn(
        self,
        robot: str | Path | RobotDescription,
        *,
        name: str | None = None,
        pose: Pose | None = None,
        x: float | None = None,
        y: float | None = None,
        z: float | None = None,
        roll: float | None = None,
        pitch: float | None = None,
        yaw: float | None = None,
        namespace: str = "/",
        frame_prefix: str = "",
        arguments: Mapping[str, str | float | Path] | None = None,
        package_path: str | Path | Sequence[str | Path] = (),
        controllers: Literal["auto"] | str | Path | Sequence[str | Path] | None = None,
    ) -> Model:
        """Spawns a model.

        Args:
            robot: A xacro, URDF or SDF file, the XML of one as text, or a description.
            name: Name in this world; None for the description's name.
            pose: Pose of the root link in the world. The file's pose is used if neither `pose` nor
                any of the following six values is given.
            x: x coordinate, m. Values that are not given are 0 if another one is given.
            y: y coordinate, m.
            z: z coordinate, m.
            roll: Rotation about the world's x axis, rad.
            pitch: Rotation about the world's y axis, rad.
            yaw: Rotation about the world's z axis, rad.
            namespace: Namespace of the robot's topics, services and actions, such as ``left``.
                Names that begin with ``/`` in the file, and namespaces in the file, are unchanged.
            frame_prefix: Prefix of the robot's frames, such as ``left``, as ROS 1's tf_prefix.
            arguments: Arguments of the xacro file. True and False are written as xacro writes them,
                ``true`` and ``false``.
            package_path: Folders to search for packages first.
            controllers: YAML files for ros_control or ros2_control, whose controllers are started;
                ``"auto"`` for the controllers that the launch files of the robot's package start.
                None starts only those that the description names, with a warning if a controller
                manager then has none; an empty list gives no warning.

        Raises:
            DescriptionError: The file cannot be used, or does not declare an argument (CW123).
            WorldError: The name is in use, or the model cannot be built.
            PluginError: A plugin cannot be used, the model has no controller manager, or a
                controller file is invalid.
            GraphError: The namespace or the frame prefix is invalid.
            CartwheelError: The pose is given twice, is not finite, or is too far away.
        """
        source(robot, "robot")
        if name is not None:
            check_model_name(text(name, "name"))
        text(frame_prefix, "frame_prefix")
        values = xacro_arguments(arguments)
        place = _place(pose, (x, y, z), (roll, pitch, yaw))
        if text(namespace, "namespace").strip("/"):
            resolve_name(namespace)
        folders = paths(package_path, "package_path")
        if not isinstance(robot, RobotDescription):
            robot = descriptions.load_robot(
                robot,
                arguments=values,
                package_path=folders,
            )
            check_xacro_arguments(robot, self._ignored)
        with self._used(change=True):
            spawned = self.session.spawn(
                robot,
                name=name,
                pose=place,
                namespace=namespace,
                frame_prefix=frame_prefix,
                controllers=_files(controllers),
                package_path=folders,
            )
            return Model(self, spawned)

    @contextlib.contextmanager
    def spawning(self) -> Iterator[None]:
        """Compiles all models that are spawned within a ``with`` block together, when it ends.

        A hundred models then take little more time than one. Until the block ends, the models are
        not in the world, so their poses cannot be read or set. If the block raises an error, none
        of them is spawned.

        Raises:
            WorldError: A model cannot be built.
            SimulationError: The world is closed.
        """
        with self._used(change=True), self.session.spawning():
            yield

    def model(self, name: str) -> Model:
        """Returns a handle to a model in the world.

        Raises:
            UnknownNameError: No model has this name.
        """
        with self.lock:
            self.session.simulation.population.resident(text(name, "name"))
        return Model(self, name)


def _with_step(world: WorldDescription, step_size: float | None) -> WorldDescription:
    """A world with a time step, s."""
    if step_size is None:
        return world
    step = scalar(step_size, "step_size", least=SHORTEST_STEP, most=LONGEST_STEP)
    return replace(world, physics=replace(world.physics, max_step_size=step))


def _files(
    controllers: str | Path | Sequence[str | Path] | None,
) -> Sequence[Path] | Literal["auto"] | None:
    """The controller files that a program gives."""
    if controllers is None:
        return None
    if controllers == "auto":
        return "auto"
    return paths(controllers, "controllers")


def _place(
    pose: Pose | None, position: tuple[float | None, ...], angles: tuple[float | None, ...]
) -> Pose | None:
    """The pose that a program gives, as a pose or as numbers; None if it gives none."""
    if pose is not None:
        instance(pose, Pose, "pose", "cartwheel.Pose((x, y, z))")
    if all(each is None for each in (*position, *angles)):
        return pose
    if pose is not None:
        raise CartwheelError(
            "a pose and single coordinates are given",
            code=OPTIONS_CONFLICT,
            hint="Pass either pose or x, y, z, roll, pitch and yaw.",
        )
    names = ("x", "y", "z", "roll", "pitch", "yaw")
    values = [
        number(_real(each, name), name)
        for each, name in zip((*position, *angles), names, strict=True)
    ]
    return Pose.from_xyz_rpy(values[:3], values[3:])


def _real(value: float | None, name: str) -> float:
    if value is not None and not isinstance(value, SupportsFloat):
        raise invalid(name, "must be a number", value)
    return float(value or 0.0)
