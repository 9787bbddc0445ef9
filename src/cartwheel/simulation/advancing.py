"""The loop of a simulation: commands, due tasks and physics."""

from __future__ import annotations

import threading
from collections.abc import Iterator, Sequence
from functools import partial
from operator import attrgetter

from cartwheel.simulation.alarms import Alarms
from cartwheel.simulation.clock import Task, always
from cartwheel.simulation.engine import Engine
from cartwheel.simulation.faults import Faults
from cartwheel.simulation.models.compilations import Compiler
from cartwheel.simulation.models.models import Models
from cartwheel.simulation.models.resident import Attach
from cartwheel.simulation.snapshot import RunState

_order = attrgetter("order")


class Advancing(Models):
    """The part of a simulation that advances time.

    Args:
        engine: The engine that simulates the models.
        attach: Creates a model's plugins.
        compiler: Compiles the models.
    """

    def __init__(self, engine: Engine, attach: Attach, compiler: Compiler) -> None:
        super().__init__(engine, attach, compiler)
        self.faults = Faults(engine, self._population)
        engine.on_fault = self.faults.disable
        self.alarms = Alarms(engine, partial(self.faults.fail, "an action"))

    def advance(self, target_ns: int) -> None:
        """Advances to a time: alternates between posted commands, due tasks and physics.

        Returns early when a command pauses, stops or resets the run. Tasks due at the target itself
        run in `complete`, or else in the next call, after any earlier commands.

        Raises:
            SimulationError: The state is no longer finite.
        """
        physics = self.engine.advance
        for count, forwarded in self.advancing(target_ns):
            physics(count, forwarded)

    def advancing(self, target_ns: int) -> Iterator[tuple[int, bool]]:
        """Advances to a time as `advance` does, with the physics left to the caller.

        Yields:
            The arguments of `Engine.advance`, which the caller must call before it continues.

        Raises:
            SimulationError: The state is no longer finite.
        """
        engine, forces, faults = self.engine, self.forces, self.faults
        population = self._population
        separation, watch = population.separation, population.watch
        motions = population.motions
        commands, running, alarms = self.commands, RunState.RUNNING, self.alarms
        empty = commands.empty
        self.owner = threading.get_ident()
        left = engine.steps_until(target_ns)
        served = engine.served_ns == engine.time_ns
        while left > 0:
            if not empty():
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
            every = schedule.every
            if every is None:
                first, last, due = schedule.at(engine.step)
            else:
                first, last, gap = every
                due = engine.step + gap
            if served:
                served = False
                if engine.served_tasks == engine.tasks_created:
                    first = last = ()
                else:
                    first, last = self._unserved(first, last)
            if not first and not last:
                forwarded = bool(engine.refreshed) and engine.is_refreshed()
            else:
                forwarded = self._serve(first, last)
                if population.schedule is not schedule:
                    # A task changed a task, the step length or the time.
                    left = engine.steps_until(target_ns)
                    due = population.schedule.at(engine.step)[2]
                if alarms.active:
                    # A task may have added an action.
                    alarm = alarms.next_step()
            end = engine.step + left
            if change is not None and change < end:
                end = change
            if alarm is not None and alarm < end:
                end = alarm
            # Without tasks, commands still do not wait longer than until the next check.
            # Comparisons take a quarter of the time of `min`.
            if watch.due < end:  # noqa: PLR1730
                end = watch.due
            if due < end and population.schedule.may_skip and empty():
                due = population.schedule.skip(due, end)
            count = (due if due < end else end) - engine.step
            if separation.roots or motions.moving or faults.pending is not None:
                count = 1
            if self.steps_allowed is not None:
                count = min(count, self.steps_allowed)
                self.steps_allowed -= count
            yield count, forwarded
            left -= count
            if motions.moving:
                motions.advance()
            if separation.roots:
                separation.limit(engine.model, engine.data)
            if engine.step >= watch.due:
                if engine.step % watch.interval == 0:
                    population.rotors.hold()
                watch.check(population.origin_of)
            if faults.pending is not None:
                faults.raise_pending()

    def looks_back(self, count: int) -> bool:
        """Whether anything that runs after the next steps may read what the last of them computed.

        These are poses, contacts and forces of the state before this step. A forward pass of the
        current state, which precedes tasks that only read, does not depend on them.

        Args:
            count: Number of steps.
        """
        population = self._population
        return (
            not self.commands.empty()
            or self.alarms.active
            or bool(population.separation.roots)
            or population.subscribers_changed
            or any(
                task.before is not None and not task.reads_state
                for task in population.schedule.at(self.engine.step + count)[0]
            )
        )

    def complete(self) -> None:
        """Runs the commands and tasks that are due at the current time, unless they have run.

        Everything that is due at this time is then published. The next `advance` begins with the
        step, and runs only tasks that were created in the meantime.

        Does nothing if the run is paused or stopped.
        """
        engine, population = self.engine, self._population
        rewinds = engine.rewinds
        if not self.commands.empty():
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
            first, last = self._unserved(first, last)
        created = engine.tasks_created
        if (first or last) and self._serve(first, last):
            engine.keep()
        engine.served_ns, engine.served_tasks = engine.time_ns, created
        if self.faults.pending is not None:
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

    def _unserved(self, *due: tuple[Task, ...]) -> Iterator[tuple[Task, ...]]:
        """Those of the due tasks that were created after `complete` has run the others."""
        served = self.engine.served_tasks
        return (tuple(task for task in tasks if task.order >= served) for tasks in due)

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
