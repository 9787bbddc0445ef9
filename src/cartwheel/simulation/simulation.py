"""The owner of the physics: models in and out, time onwards, what is due done."""

from __future__ import annotations

import itertools
import queue
from collections.abc import Callable
from concurrent.futures import Future
from typing import Any, Protocol, TypeVar

from cartwheel.description.model import RobotDescription, WorldDescription
from cartwheel.errors import Diagnostic, UnknownNameError, WorldError
from cartwheel.geometry import Pose
from cartwheel.simulation.clock import Schedule, Task, always
from cartwheel.simulation.engine import Engine
from cartwheel.simulation.guard import Guard
from cartwheel.simulation.observing import Observer
from cartwheel.simulation.part import Part
from cartwheel.simulation.separation import Separation
from cartwheel.simulation.snapshot import RunState, Scene, Snapshot
from cartwheel.world import build, unused
from cartwheel.world.entry import ModelEntry

T = TypeVar("T")
_GUARD_INTERVAL_NS = 50_000_000


class Behaviour(Protocol):
    """What a plugin is to the simulation."""

    def reset(self) -> None:
        """Time goes back to zero."""

    def close(self) -> None:
        """The model leaves the world."""


Attach = Callable[[Part], list[Behaviour]]
"""Makes the plugins of a model that is about to be spawned."""


class _Resident:
    """A model with its part and plugins."""

    def __init__(self, entry: ModelEntry, part: Part) -> None:
        self.entry = entry
        self.part = part
        self.behaviours: list[Behaviour] = []

    def close(self) -> None:
        for behaviour in self.behaviours:
            behaviour.close()


class Simulation:
    """Models in a world, stepped.

    One thread, that which calls `advance` or a `Pacer`, owns a simulation; it alone calls
    its methods. Others use `post` and `call`, and read what `snapshot` gave the owner.

    Args:
        world: Its own models are spawned at once.
        attach: Makes a model's plugins.
        seed: Of all noise.
    """

    def __init__(
        self, world: WorldDescription, *, attach: Attach = lambda _: [], seed: int = 0
    ) -> None:
        self.engine = Engine(world, seed)
        self.run_state = RunState.RUNNING
        self.speed: float | None = 1.0
        self.real_time_factor = 0.0
        self.steps_allowed: int | None = None
        """Steps until a paused simulation pauses again; None while it is not stepping singly."""
        self.commands: queue.SimpleQueue[Callable[[], None]] = queue.SimpleQueue()
        self.on_reset: list[Callable[[], None]] = []
        """Called after time went back to zero."""
        self._attach = attach
        self._residents: dict[str, _Resident] = {}
        self._schedule = Schedule()
        self._world_tasks: list[Task] = []
        self._guard = Guard()
        self._guard_due = 0
        self._separation = Separation()
        self._version = 0
        self._compile({})
        for description in world.models:
            self.spawn(description, pose=description.pose)

    @property
    def world(self) -> WorldDescription:
        return self.engine.world

    @property
    def model(self) -> Any:
        """MuJoCo's; replaced at each spawn and delete."""
        return self.engine.model

    @property
    def data(self) -> Any:
        """MuJoCo's; replaced at each spawn and delete."""
        return self.engine.data

    @property
    def diagnostics(self) -> list[Diagnostic]:
        """All that was reported so far."""
        return self.engine.diagnostics

    @property
    def scene(self) -> Scene:
        """What stands in the world."""
        return self._observer.scene

    # -- time

    @property
    def time_ns(self) -> int:
        """Simulation time."""
        return self.engine.time_ns

    @property
    def current_step(self) -> int:
        """Steps made since time zero."""
        return self.engine.step

    @property
    def step_ns(self) -> int:
        """Length of a step."""
        return self.engine.step_ns

    def advance(self, target_ns: int) -> None:
        """Runs to a time: posted commands, then what is due, then the physics, in turns.

        Ends early when a command pauses, stops or resets the run. What is due at the target
        itself is done by the next call, after the commands that come before it.

        Raises:
            SimulationError: The state is no longer finite.
        """
        engine = self.engine
        target = -(-target_ns // engine.step_ns)
        while engine.step < target:
            step = engine.step
            self.drain()
            if engine.step != step:
                return
            if self.run_state is not RunState.RUNNING and not self.steps_allowed:
                return
            due, forwarded = self._serve()
            count = 1 if self._separation.active else min(target, due) - step
            if self.steps_allowed is not None:
                count = min(count, self.steps_allowed)
                self.steps_allowed -= count
            engine.advance(count, forwarded=forwarded)
            if self._separation.active:
                self._separation.limit(engine.model, engine.data)
            if engine.step >= self._guard_due:
                self._watch()

    def drain(self) -> None:
        """Runs the commands that other threads posted."""
        while not self.commands.empty():
            self.commands.get()()

    def _serve(self) -> tuple[int, bool]:
        """Does what is due now.

        Returns:
            The step at which something is due next, and whether a forward pass was made for
            tasks that read: their state is what the physics would compute next anyway.
        """
        tasks, upcoming = self._schedule.at(self.engine.step)
        afters = []
        for task in tasks:
            if task.active is always or task.active():
                if task.before is not None:
                    task.before()
                if task.after is not None:
                    afters.append(task.after)
        if afters:
            self.engine.forward()
            for after in afters:
                after()
        return upcoming, bool(afters)

    def _watch(self) -> None:
        self._guard_due = self.engine.step + max(1, _GUARD_INTERVAL_NS // self.step_ns)
        for message in self._guard.check(self.model, self.data):
            self.engine.report(Diagnostic(severity="warning", message=message))
        self._guard.keep(self.data)

    def refresh(self) -> None:
        """Makes poses and contacts those of the present state, for reading between steps."""
        self.engine.forward()

    def pause(self) -> None:
        """Holds time."""
        if self.run_state is RunState.RUNNING:
            self.run_state = RunState.PAUSED
            self.steps_allowed = None

    def resume(self) -> None:
        """Lets time go on."""
        if self.run_state is RunState.PAUSED:
            self.run_state = RunState.RUNNING
            self.steps_allowed = None

    def step(self, count: int = 1) -> None:
        """Lets a paused simulation make `count` steps more."""
        self.pause()
        self.steps_allowed = (self.steps_allowed or 0) + count

    def stop(self) -> None:
        """Ends the run."""
        self.run_state = RunState.STOPPED

    def set_speed(self, speed: float | None) -> None:
        """Sets the wanted real-time factor; None is as fast as it can."""
        self.speed = speed

    def reset(self) -> None:
        """Takes time back to zero and every model to where it was spawned."""
        self.engine.rewind()
        self._guard_due = 0
        self._guard.forget()
        self._separation.forget()
        for resident in self._residents.values():
            for behaviour in resident.behaviours:
                behaviour.reset()
        self._schedule.restart()
        for callback in self.on_reset:
            callback()

    # -- other threads

    def post(self, function: Callable[[], None]) -> None:
        """Runs a function on the owner's thread, before the next step; from any thread."""
        self.commands.put(function)

    def call(self, function: Callable[[], T]) -> Future[T]:
        """Like `post`, with the result or the error; from any thread."""
        future: Future[T] = Future()

        def run() -> None:
            try:
                future.set_result(function())
            except Exception as error:  # noqa: BLE001 - it is the caller's to handle
                future.set_exception(error)

        self.post(run)
        return future

    # -- models

    @property
    def models(self) -> tuple[str, ...]:
        """Names of the models, in order of spawning."""
        return tuple(self._residents)

    def spawn(
        self, description: RobotDescription, *, name: str | None = None, pose: Pose | None = None
    ) -> str:
        """Puts a model into the world; everything else keeps its state.

        Args:
            description: Of the model.
            name: In this world; the description's own when None.
            pose: Of its root link in the world; the description's own when None.

        Returns:
            The name.

        Raises:
            WorldError: The name is taken or the model cannot be built; nothing has changed.
            PluginError: A plugin's parameters make no sense; nothing has changed.
        """
        name = name or description.name
        if not name or "::" in name:
            raise WorldError(f'"{name}" is no name for a model')
        if name in self._residents:
            raise WorldError(
                f'a model named "{name}" stands in the world already',
                origin=description.origin,
                hint=f'Give it another with --model, such as "{self._free_name(name)}".',
            )
        entry = ModelEntry(name=name, description=description, pose=pose or description.pose)
        resident = _Resident(entry, Part(self.engine, entry))
        try:
            resident.behaviours = self._attach(resident.part)
            self._compile({**self._residents, name: resident})
        except Exception:
            resident.close()
            raise
        resident.part.spawned = True
        notes = (*description.diagnostics, *resident.part.diagnostics, *unused(description))
        for diagnostic in notes:
            self.engine.report(diagnostic)
        self._separate(name)
        return name

    def delete(self, name: str) -> None:
        """Takes a model out of the world; everything else keeps its state.

        Raises:
            UnknownNameError: There is no such model.
        """
        resident = self._resident(name)
        self._compile({key: value for key, value in self._residents.items() if key != name})
        resident.close()

    def pose(self, name: str) -> Pose:
        """Where a model's frame is, which goes with its canonical link: a URDF's root."""
        description = self._resident(name).entry.description
        link = self.engine.link_pose(name, description.canonical_link)
        return link @ description.canonical_pose.inverse()

    def set_pose(self, name: str, pose: Pose) -> None:
        """Moves a model's frame, and with it the model, at rest.

        Raises:
            UnknownNameError: There is no such model.
        """
        entry = self._resident(name).entry
        joint = self.engine.joint_id(name, entry.description.canonical_link)
        if joint < 0:
            # It stands fixed in the world, so the world is made anew.
            entry.pose = pose
            self._compile(self._residents)
        else:
            self.engine.place(joint, pose @ entry.description.canonical_pose)
        self._separate(name)

    def joint_position(self, name: str, joint: str) -> float:
        """Position of a joint of one degree of freedom, rad or m.

        Raises:
            UnknownNameError: There is no such model or joint.
        """
        self._resident(name)
        if (name, joint) not in self.scene.joints:
            known = [other for model, other in self.scene.joints if model == name]
            raise UnknownNameError("joint", joint, known)
        return self.engine.joint_position(self.engine.joint_id(name, joint))

    def schedule(
        self,
        rate: float,
        *,
        before: Callable[[], None] | None = None,
        after: Callable[[], None] | None = None,
        active: Callable[[], bool] = always,
    ) -> None:
        """Does something of the world's at a rate in Hz, whatever models there are; see `Task`."""
        self._world_tasks.append(self.engine.task(rate, before=before, after=after, active=active))
        self._gather_tasks()

    def _gather_tasks(self) -> None:
        tasks = [task for resident in self._residents.values() for task in resident.part.tasks]
        self._schedule = Schedule([*self._world_tasks, *tasks])

    def _separate(self, name: str) -> None:
        """Sees to it that a model that was put into another one comes out gently."""
        description = self._resident(name).entry.description
        roots = {
            int(self.model.body_rootid[self.engine.body_id(name, link.name)])
            for link in description.links
        }
        overlaps = self._separation.begin(self.model, self.data, roots)
        if overlaps:
            others = ", ".join(f"{other} by {depth * 100:.0f} cm" for other, depth in overlaps)
            self.engine.report(
                Diagnostic(
                    severity="warning",
                    message=f'model "{name}" was put into {others}: they are pushed apart',
                    origin=description.origin,
                )
            )

    def _resident(self, name: str) -> _Resident:
        if name not in self._residents:
            raise UnknownNameError("model", name, self._residents)
        return self._residents[name]

    def _free_name(self, name: str) -> str:
        return next(
            f"{name}_{i}" for i in itertools.count(1) if f"{name}_{i}" not in self._residents
        )

    def _compile(self, residents: dict[str, _Resident]) -> None:
        """Compiles a new set of models and carries over the state of those that stay."""
        entries = [resident.entry for resident in residents.values()]
        self.engine.replace(build(self.world, entries).model)
        self._residents = residents
        self._version += 1
        self._guard.forget()
        for resident in residents.values():
            for handle in resident.part.handles:
                handle.bind(self.model, self.data)
        self._gather_tasks()
        self.engine.forward()
        self._separation.resume(self.model, self.data)
        self._observer = Observer(self.engine, entries, self._version)

    def snapshot(self) -> Snapshot:
        """An immutable copy of the present state."""
        return self._observer.snapshot(
            run_state=self.run_state,
            speed=self.speed,
            real_time_factor=self.real_time_factor,
        )

    def close(self) -> None:
        """Ends the run and frees what it holds."""
        self.stop()
        for resident in self._residents.values():
            resident.close()
        self.engine.renderer.close()
