"""The simulation: spawns and deletes models, advances time and runs due tasks."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from cartwheel.codes import running
from cartwheel.codes import world as world_codes
from cartwheel.description.model import RobotDescription, WorldDescription
from cartwheel.errors import (
    Diagnostic,
    DivergedError,
    Once,
    Origin,
    PluginError,
    SimulationError,
    UnknownNameError,
    WorldError,
    fault,
)
from cartwheel.geometry import Pose, Vec3
from cartwheel.simulation.adjusting import adjust
from cartwheel.simulation.clock import Schedule, Task, always, to_ns
from cartwheel.simulation.engine import Engine
from cartwheel.simulation.forces import Forces
from cartwheel.simulation.guard import Guard
from cartwheel.simulation.limits import STRONGEST, check_pose, check_steps, number, numbers
from cartwheel.simulation.naming import free_name
from cartwheel.simulation.observing import Observer
from cartwheel.simulation.part import Part
from cartwheel.simulation.placing import place_model, with_mimics
from cartwheel.simulation.resident import Attach, Resident, place, title, world_resident
from cartwheel.simulation.running import Run
from cartwheel.simulation.separation import Separation, overlap
from cartwheel.simulation.sight import in_sight
from cartwheel.simulation.snapshot import RunState, Scene, Snapshot
from cartwheel.simulation.space import Space, occupied
from cartwheel.world import build, unreadable, unused
from cartwheel.world.build import step_of
from cartwheel.world.entry import ModelEntry

_GUARD_INTERVAL_NS = 50_000_000
_RECOVERIES = 20
"""Maximum number of recovery reports: remote commands may cause divergence repeatedly."""
_FAULTS = 100
"""Maximum number of reported faults in subscribers and commands."""
_STILL: Vec3 = (0.0, 0.0, 0.0)


class Simulation(Run):
    """Models in a world, advanced in time steps.

    A single thread owns a simulation: the thread that calls `advance` or runs a `Pacer`. Only this
    thread calls the methods. Other threads use `post` and `call`, and read snapshots from the
    owner.

    Args:
        world: The world; its models are spawned immediately.
        attach: Creates a model's plugins.
        attach_world: Creates the world's plugins.
        seed: Seed for all noise.
    """

    def __init__(
        self,
        world: WorldDescription,
        *,
        attach: Attach = lambda _: [],
        attach_world: Attach = lambda _: [],
        seed: int = 0,
    ) -> None:
        super().__init__()
        self.engine = Engine(world, seed)
        self.forces = Forces(self.engine)
        self._attach = attach
        self._house = world_resident(self.engine)
        self._residents: dict[str, Resident] = {}
        self._schedule = Schedule()
        self._world_tasks: list[Task] = []
        self.engine.on_tasks.append(self._gather_tasks)
        self.engine.on_entries.append(lambda: self._compile(self._residents))
        self._guard = Guard()
        self._guard_due = 0
        self._separation = Separation()
        self._recovered = 0
        """`Engine.commanded` at the last recovery."""
        self._recoveries = 0
        self.tolerant = False
        """Whether errors in subscribers and posted functions are reported instead of raised."""
        self.strict = False
        """Whether a failing plugin stops `advance`."""
        self._failure: BaseException | None = None
        self._told_once = Once(_FAULTS)
        self.engine.on_fault = self._disable
        self._version = 0
        self._house.behaviours = attach_world(self._house.part)
        self._compile({})
        self._house.part.spawned = True
        for diagnostic in self._house.part.diagnostics:
            self.engine.report(diagnostic)
        self._populate(world.models)

    @property
    def world(self) -> WorldDescription:
        return self.engine.world

    @property
    def model(self) -> Any:
        """The MuJoCo model; replaced at each spawn and delete."""
        return self.engine.model

    @property
    def data(self) -> Any:
        """The MuJoCo data; replaced at each spawn and delete."""
        return self.engine.data

    @property
    def diagnostics(self) -> list[Diagnostic]:
        """Diagnostics reported so far."""
        return self.engine.diagnostics

    @property
    def scene(self) -> Scene:
        """The models, links and joints in the world."""
        return self._observer.scene

    # -- time

    @property
    def time_ns(self) -> int:
        """Simulation time."""
        return self.engine.time_ns

    @property
    def current_step(self) -> int:
        """Number of steps since time zero, or since the step length last changed."""
        return self.engine.step

    @property
    def step_ns(self) -> int:
        """Length of a step."""
        return self.engine.step_ns

    def advance(self, target_ns: int) -> None:
        """Advances to a time: alternates between posted commands, due tasks and physics.

        Returns early when a command pauses, stops or resets the run. Tasks due at the target itself
        run in the next call, after any earlier commands.

        Raises:
            SimulationError: The state is no longer finite.
        """
        engine, forces, separation = self.engine, self.forces, self._separation
        self.owner = threading.get_ident()
        left = engine.steps_until(target_ns)
        while left > 0:
            if not self.commands.empty():
                rewinds = engine.rewinds
                self.drain()
                if engine.rewinds != rewinds:
                    return
            if self.run_state is not RunState.RUNNING and not self.steps_allowed:
                return
            change = forces.serve() if forces.active else None
            due, forwarded = self._serve()
            if change is not None:
                due = min(due, change)
            # Recomputed, because a task may have changed the step length.
            left = engine.steps_until(target_ns)
            single = separation.active or self._failure is not None
            count = 1 if single else min(left, due - engine.step)
            if self.steps_allowed is not None:
                count = min(count, self.steps_allowed)
                self.steps_allowed -= count
            engine.advance(count, forwarded=forwarded)
            left -= count
            if separation.active:
                separation.limit(engine.model, engine.data)
            if engine.step >= self._guard_due:
                self._watch()
            if self._failure is not None:
                failure, self._failure = self._failure, None
                raise failure

    def _serve(self) -> tuple[int, bool]:
        """Runs the tasks that are due now.

        Returns:
            The step of the next due task, and whether a forward pass was made for tasks that read
            the state. The physics would compute the same pass next.
        """
        tasks, upcoming = self._schedule.at(self.engine.step)
        afters = []
        for task in tasks:
            active, before, after = task.active, task.before, task.after
            try:
                if active is always or active():
                    if before is not None:
                        before()
                    if after is not None:
                        afters.append(task)
            except Exception as error:  # noqa: BLE001 - a plugin's own
                self._task_failed(task, error)
        if afters:
            self.engine.forward()
            for task in afters:
                after = task.after
                try:
                    # None if the plugin was disabled in the meantime.
                    if after is not None:
                        after()
                except Exception as error:  # noqa: BLE001 - a plugin's own
                    self._task_failed(task, error)
        return upcoming, bool(afters)

    # -- faults in callbacks

    def defer(self, error: BaseException) -> None:
        """Raises an error from `advance` after the current step.

        Time has then advanced, and the next call continues from there.
        """
        if self._failure is None:
            self._failure = error

    def fail(self, what: str, error: Exception) -> None:
        """Handles an error in an external function: a subscriber or a posted function.

        Stops `advance`; in a `tolerant` simulation, the error is only reported once.
        """
        if not self.tolerant:
            self.defer(error)
        elif self._told_once.allows(f"{what} {error!r} {getattr(error, 'values', '')}"):
            self.engine.report(fault(f"{what} failed", error, code=world_codes.CALLBACK_FAILED))

    def command_failed(self, error: Exception) -> None:
        """See `fail`."""
        self.fail("a command", error)

    def _task_failed(self, task: Task, error: Exception) -> None:
        # Code that reads a diverged state may fail in any way: report the divergence instead.
        self._watch()
        if isinstance(error, SimulationError):
            # The simulation itself cannot continue; the plugin is not at fault.
            self.defer(error)
        elif task.owner is not None:
            self._disable(task.owner, error)
        else:
            name = getattr(task.after or task.before, "__qualname__", "a task of the simulation")
            task.forget()
            text = f"{name} failed and is disabled"
            self._report_fault(fault(text, error, code=world_codes.CALLBACK_FAILED))

    def _disable(self, plugin: object, error: Exception) -> None:
        """Disables a plugin that raised an error, and reports it; the simulation continues."""
        resident = next((each for each in self._inhabitants() if plugin in each.behaviours), None)
        if resident is None:
            # It was already disabled or deleted.
            return
        text = f"{title(plugin)} failed and is disabled"
        values = {"plugin": title(plugin)}
        diagnostic = fault(text, error, place(plugin), code=running.PLUGIN_FAILED, values=values)
        resident.end(plugin)
        self._gather_tasks()
        self._report_fault(diagnostic)

    def _report_fault(self, diagnostic: Diagnostic) -> None:
        self.engine.report(diagnostic)
        if self.strict:
            self.defer(
                PluginError(
                    diagnostic.message,
                    code=diagnostic.code,
                    origin=diagnostic.origin,
                    hint="--strict stops the run at the first error.",
                    values=diagnostic.values,
                )
            )

    def _watch(self) -> None:
        self._guard_due = self.engine.step + max(1, _GUARD_INTERVAL_NS // self.step_ns)
        for message in self._guard.check(self._place_of):
            self.engine.report(world_codes.PHYSICS_WARNING.diagnostic(message))
        self._guard.keep()

    def refresh(self) -> None:
        """Updates poses and contacts to the current state, for reading between steps."""
        self.engine.forward()

    def step(self, count: int = 1) -> None:
        """Queues `count` single steps of a paused simulation.

        Raises:
            CartwheelError: The number is not between 1 and `limits.MOST_STEPS`.
        """
        check_steps(count)
        self.pause()
        self.steps_allowed = (self.steps_allowed or 0) + count

    def reset(self, *, keep_time: bool = False) -> None:
        """Resets every model to its spawn pose, and time to zero.

        Args:
            keep_time: Do not reset time; forces on links and joints also continue.
        """
        moved = [each for each in self._residents.values() if each.entry.pose != each.start]
        for resident in moved:
            resident.entry.pose = resident.start
        if moved:
            self._compile(self._residents)
        self.engine.rewind(keep_time=keep_time)
        self._take_positions(self._residents.values())
        self._guard_due = 0
        self._guard.forget()
        self._separation.forget()
        if not keep_time:
            self.forces.forget()
        self.forces.bind()
        for resident in self._inhabitants():
            for behaviour in tuple(resident.behaviours):
                try:
                    behaviour.reset()
                except Exception as error:  # noqa: BLE001 - a plugin's own
                    self._disable(behaviour, error)
            for handle in resident.drives.values():
                handle.command(handle.target)
        if keep_time:
            return
        self._gather_tasks()
        for callback in self.on_reset:
            callback()

    def _place_of(self, body: str) -> Origin | None:
        """The origin of a body's link, or of its model."""
        for name, resident in self._residents.items():
            if body.startswith(f"{name}::"):
                description = resident.entry.description
                link = description.link(body.removeprefix(f"{name}::"))
                return link.origin if link is not None else description.origin
        return None

    def recover(self, error: DivergedError) -> bool:
        """Resets every model to its spawn pose, at rest, after a divergence; time continues.

        External commands can cause divergence, such as a huge force or a robot driven into a
        corner. A world that diverges without commands would do so again, so it is not reset.

        Returns:
            Whether the simulation can continue, because of an external action since the last
            recovery.
        """
        if self.engine.commanded == self._recovered:
            return False
        self._recovered = self.engine.commanded
        self.forces.forget()
        self.reset(keep_time=True)
        self._recoveries += 1
        if self._recoveries <= _RECOVERIES:
            last = (
                (" From now on, divergence is not reported.")
                if self._recoveries == _RECOVERIES
                else ""
            )
            self.engine.report(
                world_codes.SIMULATION_RECOVERED.diagnostic(
                    f"{error.message}; all models are reset to the poses at which they were "
                    "spawned",
                    origin=error.origin,
                    hint=f"{error.hint}{last}",
                    values=error.values,
                )
            )
        return True

    def report(self, diagnostic: Diagnostic) -> None:
        """Reports a diagnostic on the owner's thread. Thread-safe."""
        self.post_read(lambda: self.engine.report(diagnostic))

    # -- models

    @property
    def models(self) -> tuple[str, ...]:
        """Names of the models, in spawn order."""
        return tuple(self._residents)

    def spawn(
        self,
        description: RobotDescription,
        *,
        name: str | None = None,
        pose: Pose | None = None,
        namespace: str = "",
        frame_prefix: str = "",
    ) -> str:
        """Spawns a model; the rest of the state is unchanged.

        Args:
            description: The model's description.
            name: Name in this world; None for the description's name.
            pose: Pose of the root link in the world; None for the description's pose.
            namespace: Default namespace of topics and services.
            frame_prefix: Prefix of frame names.

        Returns:
            The model's name.

        Raises:
            WorldError: The name is in use or the model cannot be built; nothing has changed.
            PluginError: A plugin's parameters are invalid; nothing has changed.
            CartwheelError: The pose is not finite or too far away; nothing has changed.
        """
        name = name or description.name
        if pose is not None:
            check_pose(pose, f'model "{name}"')
        resident = self._admit(description, name, pose, namespace, frame_prefix)
        try:
            self._compile({**self._residents, name: resident})
        except Exception:
            resident.close()
            raise
        self._welcome(name)
        return name

    def delete(self, name: str) -> None:
        """Deletes a model; the rest of the state is unchanged.

        Raises:
            UnknownNameError: The model does not exist.
        """
        resident = self._resident(name)
        self._compile({key: value for key, value in self._residents.items() if key != name})
        self.forces.drop(name)
        resident.close()

    def pose(self, name: str) -> Pose:
        """Pose of a model's frame in the world; see `Engine.model_pose`."""
        return self.engine.model_pose(self._resident(name).entry)

    def in_sight(self, name: str, eyes: Sequence[Vec3], target: Vec3) -> list[bool]:
        """For each viewpoint in the world, m, whether the model is visible at the target point."""
        return in_sight(self.engine.model, self.engine.data, name, eyes, target)

    def occupied(self) -> Space:
        """The space currently occupied by collision shapes."""
        return occupied(self.engine.model, self.engine.data)

    def set_pose(self, name: str, pose: Pose) -> None:
        """Moves a model's frame, and the model with it, and stops its motion.

        Raises:
            UnknownNameError: The model does not exist.
            CartwheelError: The pose is not finite or too far away.
        """
        entry = self._resident(name).entry
        check_pose(pose, f'model "{name}"')
        self.engine.commanded += 1
        joint = self.engine.joint_id(name, entry.description.canonical_link)
        if joint < 0:
            # A model fixed to the world is recompiled at the new pose.
            entry.pose = pose
            self._compile(self._residents)
        else:
            self.engine.place(joint, pose @ entry.description.canonical_pose)
        self._separate(name)

    def namespace(self, name: str) -> str:
        """The namespace of a model's topics and services; empty for the root.

        Raises:
            UnknownNameError: The model does not exist.
        """
        return self._resident(name).part.namespace

    def moves(self, name: str) -> bool:
        """Whether a model can move in the world: it is neither static nor fixed to the world.

        Raises:
            UnknownNameError: The model does not exist.
        """
        link = self._resident(name).entry.description.canonical_link
        return self.engine.free_joint(name, link) >= 0

    def set_state(
        self, name: str, pose: Pose, *, linear: Vec3 = _STILL, angular: Vec3 = _STILL
    ) -> None:
        """Moves a model's frame and sets the velocity of the whole model as a rigid body.

        Joints keep their positions and stop. A model fixed to the world moves with its mount and
        gets no velocity.

        Args:
            name: Model name.
            pose: Pose of its frame in the world.
            linear: Velocity of the frame's origin, m/s, in world axes.
            angular: rad/s, in world axes.

        Raises:
            UnknownNameError: The model does not exist.
            CartwheelError: A number is not finite or too large.
        """
        entry = self._resident(name).entry
        check_pose(pose, f'model "{name}"')
        numbers((*linear, *angular), f'the velocity of model "{name}"')
        self.engine.commanded += 1
        if self.moves(name):
            place_model(self.engine, entry, pose, linear, angular)
        elif entry.pose != pose:
            entry.pose = pose
            self._compile(self._residents)
        self._separate(name)

    def set_joint_positions(self, name: str, positions: Mapping[str, float]) -> None:
        """Sets the positions of joints with one degree of freedom, rad or m, and stops them.

        Joints that mimic them follow.

        Raises:
            UnknownNameError: The model or a joint does not exist.
            CartwheelError: A position is not finite or too large.
        """
        description = self._resident(name).entry.description
        known = [other for model, other in self.scene.joints if model == name]
        for joint, position in positions.items():
            if joint not in known:
                raise UnknownNameError("joint", joint, known, code=world_codes.UNKNOWN_JOINT)
            number(position, f'the position of joint "{joint}"')
        self.engine.commanded += 1
        for joint, position in with_mimics(description, positions).items():
            self.engine.set_joint(self.engine.joint_id(name, joint), position)
        self.engine.forward()
        self._separate(name)

    def drive(
        self,
        name: str,
        joint: str,
        *,
        velocity: float | None = None,
        max_effort: float | None = None,
    ) -> None:
        """Drives a joint at a velocity with limited effort, like ODE's joint motors.

        At velocity 0 it brakes. For a joint with a drive plugin, it sets the plugin's velocity.

        Args:
            name: Model name.
            joint: A joint with one degree of freedom.
            velocity: rad/s or m/s; None leaves it unchanged. Initially 0.
            max_effort: N m or N; None leaves it unchanged, 0 removes the drive.

        Raises:
            UnknownNameError: The model or joint does not exist.
            WorldError: A plugin drives the joint by effort or position.
            CartwheelError: A number is not finite or too large.
        """
        if velocity is not None:
            number(velocity, f'the velocity of joint "{joint}"')
        if max_effort is not None:
            number(max_effort, f'the effort of joint "{joint}"', most=STRONGEST)
        self.engine.commanded += 1
        if self._resident(name).motorise(joint, max_effort):
            self._compile(self._residents)
        drives = self._resident(name).drives
        if velocity is not None and joint in drives:
            drives[joint].command(velocity)

    def driven(self, name: str, joint: str) -> bool:
        """Whether `drive` currently drives a joint."""
        return joint in self._resident(name).drives

    def redescribe(self, name: str, description: RobotDescription) -> None:
        """Changes properties of a model's links or joints.

        The model is recompiled and keeps its state; commands and forces continue.

        Raises:
            UnknownNameError: The model does not exist.
            WorldError: The model cannot be built; nothing has changed.
        """
        entry = self._resident(name).entry
        before = entry.description
        entry.description = description
        try:
            self._compile(self._residents)
        except Exception:
            entry.description = before
            raise

    def change_world(self, world: WorldDescription) -> None:
        """Changes gravity, lights or step length; models are unchanged.

        Raises:
            WorldError: The world cannot be built; nothing has changed.
        """
        engine = self.engine
        if adjust(engine, world):
            self._observe()
            return
        before, engine.world = engine.world, world
        try:
            self._compile(self._residents)
        except Exception:
            engine.world = before
            raise

    def frame_prefix(self, name: str) -> str:
        """The prefix of a model's frames, as set at spawn.

        Raises:
            UnknownNameError: The model does not exist.
        """
        return self._resident(name).part.frame_prefix

    def joint_position(self, name: str, joint: str) -> float:
        """Position of a joint with one degree of freedom, rad or m.

        Raises:
            UnknownNameError: The model or joint does not exist.
        """
        self._resident(name)
        if (name, joint) not in self.scene.joints:
            known = [other for model, other in self.scene.joints if model == name]
            raise UnknownNameError("joint", joint, known, code=world_codes.UNKNOWN_JOINT)
        return self.engine.joint_position(self.engine.joint_id(name, joint))

    def schedule(
        self,
        rate: float,
        *,
        before: Callable[[], None] | None = None,
        after: Callable[[], None] | None = None,
        active: Callable[[], bool] = always,
    ) -> Task:
        """Schedules callbacks of the world, independent of models, at a rate in Hz; see `Task`."""
        task = self.engine.task(rate, before=before, after=after, active=active)
        self._world_tasks.append(task)
        self._gather_tasks()
        return task

    def unschedule(self, task: Task) -> None:
        """Removes a scheduled task."""
        self._world_tasks.remove(task)
        self._gather_tasks()

    def _gather_tasks(self) -> None:
        tasks = [task for resident in self._inhabitants() for task in resident.part.tasks]
        self._schedule = Schedule(
            [*self._world_tasks, *tasks],
            step_ns=self.step_ns,
            origin_ns=self.engine.origin_ns,
        )

    def _populate(self, models: Sequence[RobotDescription]) -> None:
        """Spawns the world's models together, because each compilation takes as long as one for
        all.
        """
        for description in models:
            try:
                resident = self._admit(description, description.name)
            except Exception:
                self.close()
                raise
            self._residents[description.name] = resident
        self._compile(self._residents)
        self._take_positions(self._residents.values())
        for index, description in enumerate(models):
            self._welcome(description.name, before=models[index + 1 :])

    def _take_positions(self, residents: Iterable[Resident]) -> None:
        """Sets joints to the initial positions in their descriptions."""
        stated = [each.entry for each in residents if each.entry.description.joint_positions]
        for entry in stated:
            positions = dict(entry.description.joint_positions)
            for joint, position in with_mimics(entry.description, positions).items():
                self.engine.set_joint(self.engine.joint_id(entry.name, joint), position)
        if stated:
            self.engine.forward()

    def _admit(
        self,
        description: RobotDescription,
        name: str,
        pose: Pose | None = None,
        namespace: str = "",
        frame_prefix: str = "",
    ) -> Resident:
        """Creates a model with its plugins, before it is compiled."""
        if not name or "::" in name:
            raise WorldError(
                f'the name of a model must not be empty or contain "::" (got "{name}")',
                code=world_codes.MODEL_NAME_INVALID,
                values={"name": name},
            )
        if name in self._residents:
            free = free_name(name, self._residents)
            raise WorldError(
                f'a model named "{name}" is already in the world',
                code=world_codes.MODEL_NAME_TAKEN,
                origin=description.origin,
                hint=f'Give it another name with --model, such as "{free}".',
                values={"name": name, "free": free},
            )
        entry = ModelEntry(name=name, description=description, pose=pose or description.pose)
        part = Part(self.engine, entry, namespace=namespace, frame_prefix=frame_prefix)
        resident = Resident(entry, part)
        try:
            resident.behaviours = self._attach(resident.part)
        except Exception:
            resident.close()
            raise
        return resident

    def _welcome(self, name: str, *, before: Sequence[RobotDescription] = ()) -> None:
        """Reports diagnostics about a model that was just compiled; see `_separate`."""
        resident = self._residents[name]
        resident.part.spawned = True
        description = resident.entry.description
        notes = (*description.diagnostics, *resident.part.diagnostics)
        for diagnostic in (*notes, *unused(description), *unreadable(description)):
            self.engine.report(diagnostic)
        self._separate(name, before=before)

    def _separate(self, name: str, *, before: Sequence[RobotDescription] = ()) -> None:
        """Separates a model gently from others that it was placed in.

        Args:
            name: Model name.
            before: Models added later; overlaps with them are reported for those models.
        """
        description = self._resident(name).entry.description
        roots = {
            int(self.model.body_rootid[self.engine.body_id(name, link.name)])
            for link in description.links
        }
        overlaps = list(self._separation.begin(self.model, self.data, roots))
        if overlaps:
            later = {other.name for other in before}
            overlaps = [each for each in overlaps if each[0].partition("::")[0] not in later]
        if overlaps:
            self.engine.report(
                overlap(name, self.pose(name).z, overlaps, origin=description.origin)
            )

    def _resident(self, name: str) -> Resident:
        if name not in self._residents:
            raise UnknownNameError("model", name, self._residents, code=world_codes.UNKNOWN_MODEL)
        return self._residents[name]

    def _inhabitants(self) -> tuple[Resident, ...]:
        """The world's resident and its models."""
        return (self._house, *self._residents.values())

    def _compile(self, residents: dict[str, Resident]) -> None:
        """Compiles a new set of models and keeps the state of existing ones."""
        entries = [resident.entry for resident in residents.values()]
        built = build(self.world, [self._house.entry, *entries])
        self.engine.replace(built.model, built.alignments, built.bounces)
        step_ns = to_ns(step_of(self.world))
        if step_ns != self.engine.step_ns:
            self.engine.set_step(step_ns)
        self._residents = residents
        self.engine.entries = entries
        self._guard_due = 0
        self._guard.bind(self.model, self.data)
        self.forces.bind()
        for resident in self._inhabitants():
            for handle in resident.part.handles:
                handle.bind(self.model, self.data)
        self._gather_tasks()
        self.engine.forward()
        self._separation.resume(self.model, self.data)
        self._observe()

    def _observe(self) -> None:
        """Creates a new observer after a change of the models."""
        self._version += 1
        entries = [resident.entry for resident in self._residents.values()]
        self._observer = Observer(self.engine, entries, self._version)

    def snapshot(self) -> Snapshot:
        """An immutable copy of the current state."""
        return self._observer.snapshot(
            run_state=self.run_state,
            speed=self.speed,
            real_time_factor=self.real_time_factor,
        )

    def close(self) -> None:
        """Closes the simulation. Results can still be read.

        All reference cycles are cleared, so the memory is freed with the last reference.
        """
        if self.closed:
            return
        self.run_state = RunState.STOPPED
        # Complete the pending calls of other threads.
        self.drain()
        for resident in self._inhabitants():
            resident.close()
        self.engine.close()
        for resident in self._inhabitants():
            resident.forget()
        self._schedule = Schedule()
        self._world_tasks.clear()
        self._attach = lambda _: []
        self.end()
