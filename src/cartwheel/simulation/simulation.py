"""The simulation: advances time, runs due tasks, and resets the world."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable
from typing import Any

from cartwheel.description.model import WorldDescription
from cartwheel.errors import Diagnostic, DivergedError
from cartwheel.simulation.advancing import Advancing
from cartwheel.simulation.clock import Task, Topic, always
from cartwheel.simulation.engine import Engine
from cartwheel.simulation.limits import check_steps
from cartwheel.simulation.models.compilations import Compiler
from cartwheel.simulation.models.ground_truth import GroundTruth
from cartwheel.simulation.models.resident import Attach, reseed
from cartwheel.simulation.snapshot import RunState, Snapshot
from cartwheel.simulation.world_changes import adjust
from cartwheel.world.additions import omitted


class Simulation(Advancing):
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
        self.truth = GroundTruth(self.engine, self._population, self.forces)
        """The exact state of the models."""
        self.on_restart: list[Callable[[], None]] = []
        """Called when all models have been reset, but not when a saved state was restored."""
        try:
            self._population.start(attach_world, world.models)
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
            resident.forget_wrenches()
            for behaviour in tuple(resident.behaviours):
                try:
                    behaviour.reset()
                except (Exception, SystemExit) as error:  # noqa: BLE001 - a plugin's own
                    self.faults.disable(behaviour, error)
            for handle in resident.drives.values():
                handle.command(handle.target)
        for callback in self.on_restart:
            callback()
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
        # This is that of `Run` inlined, because messages arrive at a high rate.
        try:
            command()
        except Exception as error:  # noqa: BLE001 - another thread's code
            self.command_failed(error)

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
        self.on_restart.clear()
