"""Several worlds that run at the same time, in one thread."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Protocol

from cartwheel.api.timing import TimedWorld
from cartwheel.assembly.driver import Interruption
from cartwheel.assembly.turn import Turn
from cartwheel.messages.store import find_with, finding_with
from cartwheel.simulation.limits import duration_ns

if TYPE_CHECKING:
    from cartwheel.simulation import Simulation


class Physics(Protocol):
    """Computes the steps of worlds."""

    def advance(self, lanes: Sequence[Run]) -> None:
        """Makes the next steps of some worlds. An error of a world ends its run."""


def run_abreast(
    worlds: Sequence[TimedWorld], seconds: float, physics: Physics | None = None
) -> None:
    """Runs several worlds, with the same results as `World.run` of each.

    The worlds take turns: the Python code between two steps runs for all of them, and then the
    physics. Alone, each world would find this code displaced from the processor's caches by the
    physics, which makes it several times slower. Ctrl-C completes the current steps.

    Args:
        worlds: The worlds. Those with connections or a `pace` run one after another.
        seconds: Simulation time, at least 0.
        physics: Computes the steps of the worlds that take turns; None is MuJoCo.

    Raises:
        KeyboardInterrupt: Ctrl-C was pressed.
        Exception: A world has failed, as in `World.run`. The other worlds complete their run, and
            the first error is raised.
    """
    duration = duration_ns(seconds)
    alone = [world for world in worlds if world._is_paced]
    errors: list[Exception] = []
    with Interruption(lambda: _stop(worlds)) as interruption:
        for world in alone:
            try:
                if not interruption.pressed:
                    world.run(seconds)
            except Exception as error:  # noqa: BLE001 - raised below
                errors.append(error)
        lanes: list[Run] = []
        try:
            if not interruption.pressed:
                together = [each for each in worlds if not each._is_paced] if alone else worlds
                lanes += [Run(each, duration, errors) for each in together]
            if lanes:
                with finding_with(lanes[0].types):
                    _run(lanes, _Mujoco() if physics is None else physics)
        finally:
            for lane in lanes:
                lane.close()
    interruption.raise_pressed()
    if errors:
        raise errors[0]


def _stop(worlds: Sequence[TimedWorld]) -> None:
    for world in worlds:
        world.stop()


class _Mujoco:
    """Computes the steps of one world after the other by MuJoCo."""

    def advance(self, lanes: Sequence[Run]) -> None:
        for lane in lanes:
            lane.step()


def _run(lanes: Sequence[Run], physics: Physics) -> None:
    going = list(lanes)
    while going:
        going = [lane for lane in going if lane.prepare()]
        if going:
            physics.advance(going)


class Run(Turn):
    """A run of one world.

    Args:
        world: The world.
        duration_ns: Simulation time.
        errors: Receives the error of the world.
    """

    __slots__ = (
        "_advancing",
        "_errors",
        "_failed",
        "_open",
        "_target",
        "piece",
        "simulation",
        "types",
    )

    def __init__(self, world: TimedWorld, duration_ns: int, errors: list[Exception]) -> None:
        self._world = world
        self._errors = errors
        self.types = world.session.types
        """Finds message types for the plugins of the world."""
        self._failed = self._open = False
        try:
            self.simulation: Simulation = self.begin()
        except Exception as error:  # noqa: BLE001 - raised by `run_abreast`
            self.fail(error)
            return
        self._open = True
        self._target = self.simulation.engine.time_ns + duration_ns
        self.piece: tuple[int, bool]
        """The next steps: the arguments of `Engine.advance`."""
        self._advancing: Iterator[tuple[int, bool]] = self.simulation.advancing(self._target)

    @property
    def ends(self) -> bool:
        """Whether the run ends with the next steps."""
        engine = self.simulation.engine
        return engine.time_ns + self.piece[0] * engine.step_ns >= self._target

    def prepare(self) -> bool:
        """Does what is due before the next steps, or at the end. Returns whether there are any."""
        if self._failed:
            return False
        try:
            find_with(self.types)
            self.piece = next(self._advancing)
        except StopIteration:
            if self.simulation.engine.time_ns >= self._target:  # otherwise, the run was stopped
                self._complete()
            return False
        except Exception as error:  # noqa: BLE001 - raised by `run_abreast`
            self.fail(error)
            return False
        return True

    def step(self) -> None:
        """Makes the next steps."""
        try:
            self.simulation.engine.advance(*self.piece)
        except Exception as error:  # noqa: BLE001 - raised by `run_abreast`
            self.fail(error)

    def _complete(self) -> None:
        """Does what is due at the end."""
        try:
            self.simulation.complete()
        except Exception as error:  # noqa: BLE001 - raised by `run_abreast`
            self.fail(error)

    def close(self) -> None:
        """Ends the run."""
        if not self._open:
            return
        self._open = False
        try:
            self.end(failed=self._failed)
        except Exception as error:  # noqa: BLE001 - raised by `run_abreast`
            self.fail(error)

    def fail(self, error: Exception) -> None:
        """Ends the run with an error, which `run_abreast` raises."""
        self._failed = True
        self._errors.append(error)
