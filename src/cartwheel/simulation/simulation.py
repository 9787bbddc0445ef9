"""The simulation: advances time, runs due tasks, and resets the world."""

from __future__ import annotations

import threading
from collections.abc import Callable, Collection, Iterable, Sequence
from functools import partial
from operator import attrgetter
from typing import Any

from cartwheel.description.model import WorldDescription
from cartwheel.errors import Diagnostic, DivergedError
from cartwheel.simulation.alarms import Alarms
from cartwheel.simulation.clock import Task, Topic, always
from cartwheel.simulation.engine import Engine
from cartwheel.simulation.faults import Faults
from cartwheel.simulation.limits import check_steps
from cartwheel.simulation.models.compilations import Compiler
from cartwheel.simulation.models.ground_truth import GroundTruth
from cartwheel.simulation.models.models import Models
from cartwheel.simulation.models.resident import Attach, reseed
from cartwheel.simulation.snapshot import RunState, Snapshot
from cartwheel.simulation.world_changes import adjust
from cartwheel.world.additions import omitted

_order = attrgetter("order")


class Simulation(Models):
    """Models in a world, advanced in time steps.

    A single thread owns a simulation: the thread that calls `advance` or runs a `Pacer`. Only this
    thread calls the methods. Other threads use `post` and `call`, and read snapshots from the
    owner.

    Args:
        world: The world; its models are spawned immediately.
        attach: Creates a model's plugins.
        attach_world: Creates the world's plugins.
        seed: Seed for all noise.
        without: Names of additions to the descriptions that are omitted; see
            `cartwheel.world.additions`.
        compiler: Compiles the models; None for one of its own.

    Raises:
        WorldError: The world cannot be built.
        PluginError: A plugin's parameters are invalid.
        CartwheelError: A name in `without` is unknown.
    """

    def __init__(
        self,
        world: WorldDescription,
        *,
        attach: Attach = lambda _: [],
        attach_world: Attach = lambda _: [],
        seed: int = 0,
        without: Iterable[str] = (),
        compiler: Compiler | None = None,
    ) -> None:
        super().__init__(Engine(world, seed, omitted(without)), attach, compiler or Compiler())
        self.faults = Faults(self.engine, self._population)
        self.engine.on_fault = self.faults.disable
        self.truth = GroundTruth(self.engine, self._population, self.forces)
        """The exact state of the models."""
        self.alarms = Alarms(self.engine, partial(self.faults.fail, "an action"))
        self._population.start(attach_world)
        try:
            self._population.add_all(world.models)
        except BaseException:
            self.close()
            raise

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
        run in `complete`, or else in the next call, after any earlier commands.

        Raises:
            SimulationError: The state is no longer finite.
        """
        engine, forces, faults = self.engine, self.forces, self.faults
        population = self._population
        separation, watch = population.separation, population.watch
        commands, running, alarms = self.commands, RunState.RUNNING, self.alarms
        self.owner = threading.get_ident()
        left = engine.steps_until(target_ns)
        while left > 0:
            if not commands.empty():
                rewinds = engine.rewinds
                self.drain()
                if engine.rewinds != rewinds:
                    return
            if self.run_state is not running and not self.steps_allowed:
                return
            alarm = None
            if alarms.active:
                alarm = self._ring()
                if alarm is None or (self.run_state is not running and not self.steps_allowed):
                    return
                left = engine.steps_until(target_ns)
            change = forces.serve() if forces.active else None
            if population.subscribers_changed:
                population.gather_tasks()
            schedule = population.schedule
            first, last, due = schedule.at(engine.step)
            if engine.served_ns == engine.time_ns:
                first, last = self._unserved(first), self._unserved(last)
            if not first and not last:
                forwarded = engine.is_refreshed()
            else:
                forwarded = self._serve(first, last)
                if population.schedule is not schedule:
                    # A task changed a task, the step length or the time.
                    left = engine.steps_until(target_ns)
                    due = population.schedule.at(engine.step)[2]
            if change is not None and change < due:
                due = change
            if alarm is not None and alarm < due:
                due = alarm
            # Commands wait at most until the next check. Comparisons are faster than `min`.
            if watch.due < due:  # noqa: PLR1730
                due = watch.due
            count = due - engine.step
            if left < count:  # noqa: PLR1730
                count = left
            if separation.roots or faults.pending is not None:
                count = 1
            if self.steps_allowed is not None:
                count = min(count, self.steps_allowed)
                self.steps_allowed -= count
            engine.advance(count, forwarded)
            left -= count
            if separation.roots:
                separation.limit(engine.model, engine.data)
            if engine.step >= watch.due:
                watch.check(population.origin_of)
            if faults.pending is not None:
                faults.raise_pending()

    def complete(self) -> None:
        """Runs the commands and tasks that are due at the current time, unless they have run.

        Everything that is due at this time is then published. The next `advance` begins with the
        step, and runs only tasks that were created in the meantime.

        Does nothing if the run is paused or stopped.
        """
        engine, population = self.engine, self._population
        self.owner = threading.get_ident()
        rewinds = engine.rewinds
        self.drain()
        if engine.rewinds != rewinds or self.run_state is not RunState.RUNNING:
            return
        if self.alarms.active and (self._ring() is None or self.run_state is not RunState.RUNNING):
            return
        if self.forces.active:
            self.forces.serve()
        if population.subscribers_changed:
            population.gather_tasks()
        first, last, _ = population.schedule.at(engine.step)
        if engine.served_ns == engine.time_ns:
            first, last = self._unserved(first), self._unserved(last)
        created = engine.tasks_created
        if (first or last) and self._serve(first, last):
            engine.keep()
        engine.served_ns, engine.served_tasks = engine.time_ns, created
        self.faults.raise_pending()

    def _ring(self) -> int | None:
        """Runs the actions that are due, and the commands that they post.

        Returns:
            The step of the next action; None after a reset.
        """
        rewinds = self.engine.rewinds
        due = self.alarms.serve()
        if not self.commands.empty():
            self.drain_queued()
        return due if self.engine.rewinds == rewinds else None

    def _unserved(self, tasks: tuple[Task, ...]) -> tuple[Task, ...]:
        served = self.engine.served_tasks
        return tuple(task for task in tasks if task.order >= served) if tasks else tasks

    def _serve(self, first: Sequence[Task], last: Sequence[Task]) -> bool:
        """Runs due tasks; see `Schedule`.

        Returns:
            Whether a forward pass was made for tasks that read the state. The physics would compute
            the same pass next.
        """
        readers: list[Task] | None = None
        for task in first:
            active, before = task.active, task.before
            try:
                if active is always or active():
                    if before is not None:
                        before()
                    if task.after is not None:
                        readers = [task] if readers is None else [*readers, task]
            except (Exception, SystemExit) as error:  # noqa: BLE001 - a plugin's own
                self.faults.task_failed(task, error)
        if readers:
            last = sorted((*readers, *last), key=_order)
        if not last:
            return False
        engine = self.engine
        engine.forward()
        engine.serving = True
        try:
            for task in last:
                after = task.after
                try:
                    # None if the plugin was disabled in the meantime.
                    if after is not None:
                        after()
                except (Exception, SystemExit) as error:  # noqa: BLE001 - a plugin's own
                    self.faults.task_failed(task, error)
        finally:
            engine.serving = False
        return True

    def step(self, count: int = 1) -> None:
        """Queues `count` single steps of a paused simulation.

        Raises:
            CartwheelError: The number is not between 1 and `limits.MOST_STEPS`.
        """
        check_steps(count)
        self.pause()
        self.steps_allowed = (self.steps_allowed or 0) + count

    def refresh(self) -> None:
        """Updates poses and contacts to the current state, for reading between steps."""
        self.engine.refresh()

    def reset(self, *, keep_time: bool = False, seed: int | None = None) -> None:
        """Resets every model to its spawn pose, and time to zero.

        Args:
            keep_time: Do not reset time; forces on links and joints also continue.
            seed: New seed for all noise, at least 0; None for the same seed.
        """
        population = self._population
        self.attachments.release()
        population.return_to_start()
        self.engine.rewind(keep_time=keep_time, prepare=population.rewind_servos)
        if seed is not None:
            reseed(self.engine, population.everyone(), seed)
        population.take_positions(population.residents.values())
        population.watch.forget()
        population.separation.forget()
        if not keep_time:
            self.forces.forget()
            self.alarms.restart()
        self.forces.bind()
        for resident in population.everyone():
            for behaviour in tuple(resident.behaviours):
                try:
                    behaviour.reset()
                except (Exception, SystemExit) as error:  # noqa: BLE001 - a plugin's own
                    self.faults.disable(behaviour, error)
            for handle in resident.drives.values():
                handle.command(handle.target)
        if keep_time:
            return
        population.gather_tasks()
        for callback in self.on_reset:
            callback()

    def recover(self, error: DivergedError) -> bool:
        """Resets every model to its spawn pose, at rest, after a divergence; time continues.

        External commands can cause divergence, such as a huge force or a robot driven into a
        corner. A world that diverges without commands would do so again, so it is not reset.

        Returns:
            Whether the simulation can continue, because of an external action since the last
            recovery.
        """
        if not self._population.watch.begin_recovery():
            return False
        self.forces.forget()
        self.reset(keep_time=True)
        self._population.watch.report_recovery(error)
        return True

    def change_world(self, world: WorldDescription) -> None:
        """Changes gravity, lights or step length; models are unchanged.

        Raises:
            WorldError: The world cannot be built; nothing has changed.
        """
        engine = self.engine
        gravity = engine.world.gravity
        if adjust(engine, world):
            if world.gravity != gravity:
                self._population.drag_again()
            self._population.observe()
            return
        before, engine.world = engine.world, world
        try:
            self._population.compile()
        except BaseException:
            engine.world = before
            raise

    def schedule(
        self,
        rate: float,
        *,
        before: Callable[[], None] | None = None,
        after: Callable[[], None] | None = None,
        active: Callable[[], bool] = always,
        topics: Collection[Topic] | None = None,
    ) -> Task:
        """Schedules callbacks of the world, independent of models, at a rate in Hz; see `Task`."""
        task = self.engine.task(rate, before=before, after=after, active=active, topics=topics)
        self._population.world_tasks.append(task)
        self._population.gather_tasks()
        return task

    def note_subscribers(self) -> None:
        """Lets tasks sleep or wake before the next step, by their topics. Thread-safe."""
        self._population.subscribers_changed = True

    def unschedule(self, task: Task) -> None:
        """Removes a task of `schedule`."""
        self._population.world_tasks.remove(task)
        self._population.gather_tasks()

    def _obey(self, command: Callable[[], None]) -> None:
        self.engine.note_change()
        super()._obey(command)

    def command_failed(self, error: Exception) -> None:
        """Handles an error in a posted function; see `Faults.fail`."""
        self.faults.fail("a command", error)

    def report(self, diagnostic: Diagnostic) -> None:
        """Reports a diagnostic on the owner's thread. Thread-safe."""
        self.post_read(lambda: self.engine.report(diagnostic))

    def snapshot(self) -> Snapshot:
        """An immutable copy of the current state."""
        return self._population.observer.snapshot(
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
        self.alarms.close()
        self._population.close()
        self.end()
