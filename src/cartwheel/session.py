"""A complete simulation: world, graph, plugins and clock."""

from __future__ import annotations

import contextlib
import functools
import weakref
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, Protocol

from cartwheel.codes.running import CONTROLLER_NOT_STARTED
from cartwheel.component import Shared, TopicSharing
from cartwheel.description.files.package_files import SimulationPackages
from cartwheel.description.files.readings import Readings
from cartwheel.description.launches import LaunchUse
from cartwheel.description.model import RobotDescription, WorldDescription
from cartwheel.dialects.gz.bridge_file import Bridge, entries_of
from cartwheel.dialects.plugin_files import PluginFiles
from cartwheel.dialects.registry import attach
from cartwheel.dialects.ros_control.files import ControllerFiles
from cartwheel.dialects.ros_control.selection import (
    Selection,
    selection,
    selection_near,
    with_published_control,
    world_with_published_control,
)
from cartwheel.dialects.ros_control.suggestion import lacks_controllers, no_controllers, suggested
from cartwheel.dialects.world_plugins import attach_world
from cartwheel.errors import CartwheelError, Code, Diagnostic, PluginError
from cartwheel.geometry import Pose
from cartwheel.graph import Graph, check_prefix
from cartwheel.graph.topic import Subscription
from cartwheel.messages import Form, zero
from cartwheel.messages.library.library import TypeLibrary
from cartwheel.messages.store import finding_with
from cartwheel.options import STRICT
from cartwheel.simulation import Part, Simulation
from cartwheel.simulation.clock import Task
from cartwheel.simulation.models.compilations import Compiler
from cartwheel.simulation.models.resident import Behaviour, Resident
from cartwheel.simulation.pacing import Pacer

CLOCK_RATE = 100.0
"""Default rate of ``/clock``, Hz of simulation time."""


@dataclass(frozen=True, slots=True)
class Spawned:
    """What spawning a model needs besides its description and its place."""

    controllers: tuple[Path, ...] = ()
    """Controller files."""
    controller_names: tuple[str, ...] = ()
    """Those in these files that are started; empty for all but the idle ones."""
    idle_controllers: tuple[str, ...] = ()
    """Those that are loaded, but not started."""
    package_path: tuple[Path, ...] = ()
    """Folders to search for packages first."""
    arguments: tuple[tuple[str, tuple[str, ...]], ...] = ()
    """Names of controllers, with the ROS arguments of their nodes."""


class RobotPublisher(Protocol):
    """Publishes about a session's robots, such as their descriptions; see `cartwheel.gazebo`."""

    def update(self) -> None:
        """Publishes new robots at once."""

    def close(self) -> None:
        """Stops publishing."""

    def forget(self) -> None:
        """Clears the references of the tasks of a closed simulation."""


class Session:
    """A simulation with its graph.

    Args:
        world: The world at startup.
        seed: Seed for all noise.
        strict: Treat every warning about a file as an error, unless its code is in `ignore`.
        lenient: Skip plugins that cannot be created, for example because a parameter is invalid,
            and report an error, as in `cartwheel run`. Otherwise the model is rejected.
        bridge: Configuration files of ros_gz_bridge, which define topic names, or their entries.
        plugins: Python files that define plugins. They are executed.
        allow_path: Folders with files that clients of the session's services may load.
        package_path: Folders to search for the packages of message types first.
        without: Physics that Cartwheel adds to descriptions, to be omitted; see `Simulation`.
        compiler: Compiles the models; None for one of its own.
        readings: Stores what is read of controller files; None: they are read for each model.

    Raises:
        CartwheelError: The world or a configuration file cannot be used.
    """

    def __init__(
        self,
        world: WorldDescription,
        *,
        seed: int = 0,
        strict: bool = False,
        lenient: bool = False,
        bridge: Sequence[Bridge] = (),
        plugins: Sequence[Path] = (),
        allow_path: Sequence[Path] = (),
        package_path: Sequence[Path] = (),
        without: Sequence[str] = (),
        compiler: Compiler | None = None,
        readings: Readings | None = None,
        ignore: frozenset[Code] = frozenset(),
    ) -> None:
        self.allow_path = tuple(allow_path)
        self._packages = SimulationPackages(package_path)
        self.types = TypeLibrary(self._packages)
        """The message types that the session's packages define."""
        early: list[Diagnostic] = []
        self.types.report = early.append
        self.graph = Graph(types=self.types)
        self.shared = Shared(self.graph)
        """Objects that all components of the simulation share."""
        for entry in bridge:
            self.shared.renaming.add(entries_of(entry))
        for path in plugins:
            self._packages.add(path)
        self._packages.add(world.origin.file)
        self.shared.get(ControllerFiles).readings = readings
        with finding_with(self.types):
            for path in plugins:
                self.shared.get(PluginFiles).load(path)
        self.strict = strict
        self._spawning = False
        self.spawned: dict[str, Spawned] = {}
        """How each model was spawned, by its name."""
        self.originals: weakref.WeakKeyDictionary[object, Any] = weakref.WeakKeyDictionary()
        """For each saved state, the objects that were saved; see `cartwheel.saving`."""
        # Without a reference to the session, because the simulation would keep it alive.
        types, shared = self.types, self.shared

        def attach_model(part: Part) -> list[Behaviour]:
            with finding_with(types):
                return attach(part, shared, lenient=lenient)

        def attach_to_world(part: Part) -> list[Behaviour]:
            with finding_with(types):
                return attach_world(part, shared)

        self.simulation = Simulation(
            world_with_published_control(world, package_path),
            attach=attach_model,
            attach_world=attach_to_world,
            seed=seed,
            without=without,
            compiler=compiler,
        )
        self.graph.post = self.simulation.post
        self.simulation.on_restart.append(self.graph.abort_goals)
        self.graph.post_read = self.simulation.post_read
        self.types.report = self.simulation.report
        for each in early:
            self.simulation.report(each)
        self.graph.on_demand = self.simulation.note_subscribers
        self.graph.on_error = self._subscriber_failed
        self.simulation.faults.strict, self.simulation.faults.ignore = strict, ignore
        self._clock = self.graph.advertise(
            "/clock", "rosgraph_msgs/msg/Clock", node="cartwheel", rate=CLOCK_RATE
        )
        self._clock_form = Form(functools.partial(zero, "rosgraph_msgs/msg/Clock"), "clock")
        self._clock_task = self._schedule_clock(CLOCK_RATE)
        self.descriptions: RobotPublisher | None = None
        """What publishes the descriptions of the robots, while something needs them."""
        self.states: RobotPublisher | None = None
        """What publishes the transforms of the robots' links, while something needs them."""
        self.others_publish_states = False
        """Whether these transforms are left to other nodes, such as robot_state_publisher."""
        self._sharing = TopicSharing(self.graph, self.simulation)
        self._check(0)

    def spawn(
        self,
        description: RobotDescription,
        *,
        name: str | None = None,
        pose: Pose | None = None,
        namespace: str = "/",
        frame_prefix: str = "",
        controllers: Sequence[Path] | LaunchUse | Literal["auto"] | None = (),
        package_path: Sequence[Path] = (),
    ) -> str:
        """Spawns a model as `Simulation.spawn` does; in strict mode, warnings are errors.

        Call it on the owner's thread.

        Args:
            description: The model's description.
            name: Name in this world; None for the description's name.
            pose: Pose of the root link; None for the description's pose.
            namespace: Default namespace of topics and services, as "/" in ROS 1's spawn_model. ""
                leaves the default to each plugin.
            frame_prefix: Prefix of frame names.
            controllers: YAML files whose controllers the model's controller manager starts. "auto"
                selects those that the launch files of the model's package start, and a `LaunchUse`
                those that one launch file starts. None selects none, with a warning if the
                controller manager then has none.
            package_path: Folders to search for the packages of message types first.

        Raises:
            PluginError: The model has no controller manager.
            GraphError: The prefix of the frames is invalid.
        """
        check_prefix(frame_prefix)
        if self._packages.add(description.origin.file, package_path):
            self.types.forget_missing()
        with self.spawning():
            known = self.shared.get(ControllerFiles).known
            description = with_published_control(description, package_path=package_path)
            lacking = functools.partial(lacks_controllers, description)
            if controllers is None and known(description, "lacking", lacking):
                found = known(description, "suggested", lambda: suggested(description))
                self.simulation.engine.report(no_controllers(description, found))
            if controllers == "auto":
                nearby = functools.partial(selection_near, description, package_path)
                chosen = known(description, ("selection", *package_path), nearby)
            elif isinstance(controllers, LaunchUse):
                chosen = selection(description, controllers, (controllers,))
            else:
                chosen = Selection(files=tuple(map(Path, controllers or ())), names=())
            for each in chosen.problems:
                self.simulation.engine.report(each)
            spawned = self._spawn(
                description,
                chosen,
                name=name,
                pose=pose,
                namespace=namespace,
                frame_prefix=frame_prefix,
            )
        how = (chosen.files, chosen.names, chosen.idle, tuple(package_path), chosen.arguments)
        self.spawned[spawned] = Spawned(*how)
        return spawned

    def _spawn(self, description: RobotDescription, controllers: Selection, **options: Any) -> str:
        files = self.shared.get(ControllerFiles)
        files.offer(controllers.files, controllers.names, controllers.idle, controllers.arguments)
        try:
            spawned = self.simulation.spawn(description, **options)
        finally:
            left = files.withdraw()
        if left:
            self.simulation.withdraw(spawned)
            raise PluginError(
                f'model "{spawned}" has no plugin that starts controllers',
                code=CONTROLLER_NOT_STARTED,
                values={"model": spawned},
                origin=description.origin,
                hint="Add the plugin libgazebo_ros_control.so, libgazebo_ros2_control.so or "
                "gz_ros2_control-system in a <gazebo> tag.",
            )
        return spawned

    def admit(
        self,
        description: RobotDescription,
        name: str,
        *,
        pose: Pose,
        namespace: str,
        frame_prefix: str,
        how: Spawned,
    ) -> Resident:
        """Creates a model again, to be compiled afterwards; see `spawn` and `Population.admit`."""
        if self._packages.add(description.origin.file, how.package_path):
            self.types.forget_missing()
        files = self.shared.get(ControllerFiles)
        files.offer(how.controllers, how.controller_names, how.idle_controllers, how.arguments)
        try:
            resident = self.simulation.population.admit(
                description, name, pose, namespace, frame_prefix
            )
        finally:
            files.withdraw()
        resident.part.spawned = True
        self.spawned[name] = how
        return resident

    @contextlib.contextmanager
    def spawning(self) -> Iterator[None]:
        """Compiles all models that are spawned within the block together, when it ends.

        In strict mode, a warning about one of them is an error, and none of them is spawned. Call
        it on the owner's thread; see `Simulation.spawning`.
        """
        if self._spawning:
            yield
            return
        simulation, self._spawning = self.simulation, True
        before, known = len(simulation.diagnostics), simulation.models
        try:
            with simulation.spawning():
                yield
        finally:
            self._spawning = False
        self._sharing.report()
        try:
            self._check(before)
        except CartwheelError:
            simulation.delete(*(name for name in simulation.models if name not in known))
            raise

    def update_robots(self) -> None:
        """Publishes descriptions and transforms of new robots, if any are published."""
        for each in (self.descriptions, self.states):
            if each is not None:
                each.update()

    def report_unbridged(self) -> None:
        """Reports missing topics listed in ros_gz_bridge files. Call it on the owner's thread."""
        before = len(self.simulation.diagnostics)
        for fault in self.shared.renaming.faults({topic.name for topic in self.graph.topics()}):
            self.simulation.engine.report(fault)
        self._check(before)

    def set_clock_rate(self, rate: float) -> None:
        """Sets the publish rate of ``/clock``. Call it on the owner's thread.

        Args:
            rate: Hz of simulation time; 0 or more than the step rate publishes at every step.
        """
        self.simulation.unschedule(self._clock_task)
        self._clock_task = self._schedule_clock(rate)

    @property
    def diagnostics(self) -> tuple[Diagnostic, ...]:
        """Diagnostics reported so far."""
        return tuple(self.simulation.diagnostics)

    @property
    def notes(self) -> dict[str, str]:
        """Version, world, seed, step length and models, as metadata for recordings."""
        import cartwheel

        simulation = self.simulation
        return {
            "version": cartwheel.__version__,
            "world": simulation.world.name,
            "seed": str(simulation.engine.seed),
            "step_ns": str(simulation.step_ns),
            "models": ", ".join(simulation.models),
            **({"without": ", ".join(sorted(omit))} if (omit := simulation.engine.without) else {}),
        }

    def pacer(self, *, until_ns: int | None = None) -> Pacer:
        """Creates a pacer that runs the session against the wall clock."""
        return Pacer(self.simulation, until_ns=until_ns, strict=self.strict)

    def _subscriber_failed(self, subscription: Subscription, error: BaseException) -> None:
        what = f'the subscriber "{subscription.node}" of {subscription.topic}'
        self.simulation.faults.fail(what, error)

    def close(self) -> None:
        """Stops the simulation; see `Simulation.close`."""
        self.simulation.close()
        self.originals.clear()
        self.types.report = _ignore
        self.shared.get(ControllerFiles).loaded.clear()
        self.graph.close()
        self._clock_task.forget()
        for each in (self.descriptions, self.states):
            if each is not None:
                each.forget()
        self.descriptions = self.states = None

    def _check(self, start: int) -> None:
        for each in self.simulation.diagnostics[start:] if self.strict else ():
            if each.severity == "info" or each.code in self.simulation.faults.ignore:
                continue
            error = CartwheelError(
                each.message,
                code=each.code,
                origin=each.origin,
                hint=f"{each.hint} {STRICT.given()} makes every warning an error.".lstrip(),
                values=each.values,
                mark=each.mark,
            )
            if each.details:
                error.add_note(each.details)
            raise error

    def _schedule_clock(self, rate: float) -> Task:
        return self.simulation.schedule(rate, after=self._publish_clock, topics=[self._clock])

    def _publish_clock(self) -> None:
        self._clock.publish_values(self._clock_form, (self.simulation.engine.time_ns,))


def _ignore(_: Diagnostic) -> None:
    """Receives the diagnostics of a closed session."""
