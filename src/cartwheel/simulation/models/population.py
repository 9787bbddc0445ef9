"""The models in a simulation: their plugins and tasks, and the compilation of all models."""

from __future__ import annotations

import contextlib
from collections.abc import Collection, Iterable, Iterator, Sequence

from cartwheel.codes import world as world_codes
from cartwheel.description.model import RobotDescription
from cartwheel.errors import Diagnostic, Origin, WorldError
from cartwheel.geometry import Pose
from cartwheel.options import NAME
from cartwheel.simulation.clock import Schedule, Task, to_ns
from cartwheel.simulation.divergence_watch import Watch
from cartwheel.simulation.dynamics.joint_servo import ServoHandle
from cartwheel.simulation.dynamics.separation import STILL, Separation, Speeds, overlap
from cartwheel.simulation.dynamics.velocity_motor import JointStop, MotorHandle
from cartwheel.simulation.engine import Engine
from cartwheel.simulation.handles import JointHandle
from cartwheel.simulation.models.compilations import Compiler
from cartwheel.simulation.models.forces import Forces
from cartwheel.simulation.models.in_place import InPlace
from cartwheel.simulation.models.motions import Motions
from cartwheel.simulation.models.placement import with_mimics
from cartwheel.simulation.models.resident import Attach, Resident, unknown_model, world_resident
from cartwheel.simulation.models.rotors import Rotors
from cartwheel.simulation.models.unique_names import check_model_name, free_name
from cartwheel.simulation.observer import Observer
from cartwheel.simulation.part import Part
from cartwheel.world import reports
from cartwheel.world.additions import Added
from cartwheel.world.build import step_of
from cartwheel.world.entry import ModelEntry


class Population:
    """The models in a world, the world's own plugins, and the schedule of all their tasks.

    Args:
        engine: The engine that simulates the models.
        forces: Forces on links and joints; bound again after each compilation.
        attach: Creates a model's plugins.
        compiler: Compiles the models.
    """

    def __init__(self, engine: Engine, forces: Forces, attach: Attach, compiler: Compiler) -> None:
        self._engine = engine
        self._compiler = compiler
        self._forces = forces
        self.attach = attach
        self.watch = Watch(engine)
        self.rotors = Rotors()
        self.separation = Separation(slow="slow-separation" not in engine.without)
        self.house = world_resident(engine)
        """The world's own plugins."""
        self.residents: dict[str, Resident] = {}
        """By model name, in spawn order."""
        self.world_tasks: list[Task] = []
        """Tasks that belong to no model and no plugin."""
        self.schedule = Schedule()
        self.subscribers_changed = False
        """Whether tasks may have to sleep or wake. Other threads may set it."""
        self._entered: dict[str, Resident] | None = None
        """Models to be compiled at the end of `entering`."""
        self.deleted: set[str] = set()
        """Names of models that were deleted, for errors."""
        self._version = 0
        self._added: tuple[Added, ...] = ()
        """What was added to the descriptions of the compiled models."""
        self._in_place = InPlace(engine)
        self.motions = Motions(engine, self._in_place, self.separation)

    def start(self, attach_world: Attach, descriptions: Sequence[RobotDescription]) -> None:
        """Creates the world's plugins and spawns its models, with one compilation.

        Raises:
            PluginError: A plugin's parameters are invalid.
            WorldError: Two models have the same name, or the world cannot be built.
        """
        self._engine.on_tasks.append(self.gather_tasks)
        self._engine.on_entries.append(self.compile)
        self.house.attach(attach_world)
        for description in descriptions:
            self.residents[description.name] = self.admit(description, description.name)
        self.compile()
        self.take_positions(self.residents.values())
        self.house.part.spawned = True
        for diagnostic in self.house.part.diagnostics:
            self._engine.report(diagnostic)
        self._welcome_all([description.name for description in descriptions])

    def everyone(self) -> tuple[Resident, ...]:
        """The world's own resident, followed by the models in spawn order."""
        return (self.house, *self.residents.values())

    def resident(self, name: str) -> Resident:
        """A model.

        Raises:
            UnknownNameError: The model does not exist.
        """
        if name not in self.residents:
            raise unknown_model(name, self.residents, self.deleted)
        return self.residents[name]

    def owner_of(self, plugin: object) -> Resident | None:
        """The model or world that a plugin belongs to; None if the plugin is disabled."""
        return next((each for each in self.everyone() if plugin in each.behaviours), None)

    @contextlib.contextmanager
    def entering(self) -> Iterator[None]:
        """Compiles all models that `enter` within the block, when the outermost block ends.

        Raises:
            WorldError: A model cannot be built; nothing has changed.
        """
        if self._entered is not None:
            yield
            return
        entered = self._entered = {}
        try:
            yield
            if entered:
                self.compile({**self.residents, **entered})
        except BaseException:
            for resident in entered.values():
                resident.close()
            raise
        finally:
            self._entered = None
        self._welcome_all(list(entered))

    def enter(
        self,
        description: RobotDescription,
        name: str,
        pose: Pose | None,
        namespace: str,
        frame_prefix: str,
    ) -> None:
        """Creates a model within `entering`; see `admit`."""
        assert self._entered is not None
        resident = self.admit(description, name, pose, namespace, frame_prefix)
        self._entered[name] = resident

    def withdraw(self, name: str) -> None:
        """Removes a model again within the block in which it entered."""
        assert self._entered is not None
        self._entered.pop(name).close()

    def _welcome_all(self, names: Sequence[str]) -> None:
        for index, name in enumerate(names):
            self.welcome(name, before=names[index + 1 :])

    def admit(
        self,
        description: RobotDescription,
        name: str,
        pose: Pose | None = None,
        namespace: str = "",
        frame_prefix: str = "",
    ) -> Resident:
        """Creates a model with its plugins, to be compiled afterwards.

        Args:
            description: The model's description.
            name: Name in this world.
            pose: Pose of the root link in the world; None for the description's pose.
            namespace: Default namespace of topics and services.
            frame_prefix: Prefix of frame names.

        Raises:
            WorldError: The name is in use, empty or contains "::".
            PluginError: A plugin's parameters are invalid.
        """
        check_model_name(name)
        if name in self.residents or name in (self._entered or {}):
            free = free_name(name, self.residents.keys() | (self._entered or {}).keys())
            raise WorldError(
                f'a model named "{name}" is already in the world',
                code=world_codes.MODEL_NAME_TAKEN,
                origin=description.origin,
                hint=f"Choose another name, such as {NAME.given(free)}.",
                values={"name": name, "free": free},
            )
        entry = ModelEntry(name=name, description=description, pose=pose or description.pose)
        part = Part(self._engine, entry, namespace=namespace, frame_prefix=frame_prefix)
        resident = Resident(entry, part)
        try:
            resident.attach(self.attach)
        except BaseException:
            resident.close()
            raise
        return resident

    def compile(self, residents: dict[str, Resident] | None = None) -> None:
        """Compiles the models and keeps the state of existing ones.

        Args:
            residents: The new set of models; None compiles the current set again.

        Raises:
            WorldError: The world cannot be built; nothing has changed.
        """
        engine = self._engine
        residents = self.residents if residents is None else residents
        entries = [resident.entry for resident in residents.values()]
        everything = [self.house.entry, *entries]
        compiled = self._compiler.compile(engine.world, everything, engine.without)
        built = compiled.build
        self._added = built.added
        engine.replace(built.model, built.alignments, built.bounces, compiled.compile_visuals)
        step_ns = to_ns(step_of(engine.world, everything))
        if step_ns != engine.step_ns:
            engine.set_step(step_ns)
        self.residents = residents
        engine.entries = entries
        self._in_place.bind(built, entries)
        self.motions.gather()
        self.watch.bind(engine.model, engine.data)
        self._forces.bind()
        for resident in self.everyone():
            for handle in resident.part.handles:
                handle.bind(engine.model, engine.data)
        self.rotors.bind(resident.part for resident in self.everyone())
        self.gather_tasks()
        engine.forward()
        self.separation.resume(engine.model, engine.data)
        self.observe()

    def describe(self, name: str, description: RobotDescription) -> None:
        """Changes the description of a model: without a compilation, if that is possible.

        Raises:
            UnknownNameError: The model does not exist.
            WorldError: The model cannot be built; nothing has changed.
        """
        resident = self.resident(name)
        entry, before = resident.entry, resident.entry.description
        known = {(each.addition, each.element) for each in self._added if each.model == name}
        entry.description = description
        try:
            added = self._in_place.describe(entry, before)
            if added is None:
                self.compile()
                added = [*self._added]
        except BaseException:
            entry.description = before
            raise
        if self._in_place.recompiles_visuals():
            engine, entries = self._engine, [each.entry for each in self.everyone()]
            engine.visuals.replace(self._compiler.visuals(engine.world, entries, engine.without))
        self._refresh_handles(resident)
        self.observe()
        new = [each for each in added if (each.addition, each.element) not in known]
        self._added = (*self._added, *new)
        for diagnostic in reports(new, name):
            self._engine.report(diagnostic)

    def place(self, name: str, pose: Pose) -> None:
        """Moves a model that is fixed to the world: without a compilation, if that is possible.

        Raises:
            UnknownNameError: The model does not exist.
            WorldError: The model cannot be built; nothing has changed.
        """
        resident = self.resident(name)
        entry, before = resident.entry, resident.entry.pose
        entry.pose = pose
        self.motions.set(entry, None)
        if self._in_place.place(entry, self._engine.world.joints):
            self._refresh_handles(resident)
            self._engine.refresh()
            self.observe()
            return
        try:
            self.compile()
        except BaseException:
            entry.pose = before
            raise

    def drag_again(self) -> None:
        """Computes the drag of chains for a changed gravity."""
        self._in_place.drag()

    def _refresh_handles(self, resident: Resident) -> None:
        """Lets handles read the constants of the compiled model again, as after a compilation."""
        self.rotors.hold()
        for handle in resident.part.handles:
            if isinstance(handle, JointHandle):
                handle.bind(self._engine.model, self._engine.data)
            elif isinstance(handle, ServoHandle | JointStop | MotorHandle):
                handle.refresh(self._engine.model)

    def observe(self) -> None:
        """Creates a new observer and scene version after a change of the models or lights."""
        self._version += 1
        entries = [resident.entry for resident in self.residents.values()]
        self.observer = Observer(self._engine, entries, self._version)

    def gather_tasks(self) -> None:
        """Creates a new schedule after tasks or the step length changed."""
        self.subscribers_changed = False
        tasks = [task for resident in self.everyone() for task in resident.part.tasks]
        self.schedule = Schedule(
            [*self.world_tasks, *tasks],
            step_ns=self._engine.step_ns,
            origin_ns=self._engine.origin_ns,
        )

    def take_positions(self, residents: Iterable[Resident]) -> None:
        """Sets joints to the initial positions in their descriptions."""
        stated = [each.entry for each in residents if each.entry.description.joint_positions]
        for entry in stated:
            positions = dict(entry.description.joint_positions)
            for joint, position in with_mimics(entry.description, positions).items():
                self._engine.set_joint(self._engine.joint_id(entry.name, joint), position)
        if stated:
            self._engine.forward()

    def return_to_start(self) -> None:
        """Moves models that are fixed to the world back to their spawn poses."""
        for name, resident in self.residents.items():
            if resident.entry.pose != resident.start or resident.entry.motion is not None:
                self.place(name, resident.start)

    def rewind_servos(self) -> None:
        """Returns all servos to the commands that they had when their models were spawned."""
        for resident in self.everyone():
            resident.rewind_servos()

    def welcome(self, name: str, *, before: Collection[str] = ()) -> None:
        """Reports the diagnostics of a model that was just compiled; see `separate`."""
        self.residents[name].part.spawned = True
        for diagnostic in self.diagnostics_of(name):
            self._engine.report(diagnostic)
        self.separate(name, before=before)

    def diagnostics_of(self, name: str) -> tuple[Diagnostic, ...]:
        """What is reported about a model when it is spawned."""
        resident = self.residents[name]
        description = resident.entry.description
        notes = self._compiler.notes(description)
        return (
            *description.diagnostics,
            *resident.part.diagnostics,
            *notes.unused,
            *reports(self._added, name),
            *notes.unreadable,
        )

    def separate(self, name: str, speeds: Speeds = STILL, *, before: Collection[str] = ()) -> None:
        """Starts to separate a model from the models that it overlaps, and reports the overlaps.

        Args:
            name: Model name.
            speeds: Those at which it moves along a path; see `Separation.begin`.
            before: Names of models spawned later, which report their overlaps with this model.

        Raises:
            UnknownNameError: The model does not exist.
        """
        engine = self._engine
        entry = self.resident(name).entry
        description = entry.description
        roots = {
            int(engine.model.body_rootid[engine.body_id(name, link.name)])
            for link in description.links
        }
        overlaps = list(self.separation.begin(engine.model, engine.data, roots, speeds))
        overlaps = [each for each in overlaps if each[0].partition("::")[0] not in before]
        if overlaps:
            height = engine.model_pose(entry).z
            engine.report(overlap(name, height, overlaps, origin=description.origin))

    def close(self) -> None:
        """Closes all plugins, and then the engine."""
        for resident in self.everyone():
            resident.close()
        self._engine.close()
        for resident in self.everyone():
            resident.forget()
        self.schedule = Schedule()
        self.world_tasks.clear()
        self.attach = lambda _: []

    def origin_of(self, body: str) -> Origin | None:
        """The origin of a body's link, or of its model."""
        for name, resident in self.residents.items():
            if body.startswith(f"{name}::"):
                description = resident.entry.description
                link = description.link(body.removeprefix(f"{name}::"))
                return link.origin if link is not None else description.origin
        return None
