"""Evaluation of conditions while a world runs."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

from cartwheel.errors import CartwheelError, Origin, UnknownNameError
from cartwheel.testing.conditions import Condition, StaysWithin
from cartwheel.testing.publishing import Publishes
from cartwheel.testing.touching import Touches

if TYPE_CHECKING:
    from cartwheel.api import World

When = Literal["once", "always", "end"]
SAMPLING = 0.02
"""Interval of simulation time in which conditions are evaluated, s."""
_TIME_ERROR = 1e-9
"""Accuracy of times in s, which are sums of floating-point numbers."""


@dataclass(eq=False)
class Watch:
    """A condition, and when it must be met.

    Attributes:
        when: ``once`` by the timeout, ``always``, or at the ``end``.
        timeout: Simulation time from the start, s; None is the end.
        after: Simulation time from the start at which the condition begins, s.
        patient: Whether models, joints and topics of the condition may be added later.
        origin: Where the condition is stated, for its errors.
    """

    condition: Condition
    when: When
    timeout: float | None = None
    after: float = 0.0
    patient: bool = False
    origin: Origin | None = None
    met: bool | None = field(default=None, init=False)
    """None while it is undecided."""
    time: float | None = field(default=None, init=False)
    """Simulation time from the start at which it was decided, s."""
    begun: bool = field(default=False, init=False)
    """Whether the time `after` has come."""
    _start: float = field(default=0.0, init=False)
    _missing: UnknownNameError | None = field(default=None, init=False)
    """What does not exist yet."""
    _known: bool = field(default=False, init=False)

    def begin(self, world: World) -> None:
        """Starts the watch; see `Condition.begin` for the errors."""
        self._start = world.time
        try:
            self.condition.begin(world)
        except UnknownNameError as error:
            self._wait_for(error)
        if self.after <= 0:
            self.begun = True
            self.look(world)

    def look(self, world: World) -> None:
        """Evaluates the condition.

        Raises:
            UnknownNameError: A model, joint or topic does not exist, or not by the timeout.
            CartwheelError: The condition cannot be evaluated.
        """
        try:
            self._look(world)
        except CartwheelError as error:
            error.origin = error.origin or self.origin
            raise

    def _look(self, world: World) -> None:
        now = world.time - self._start
        if self.met is not None or now < self.after - _TIME_ERROR:
            return
        try:
            if not self.begun or self._missing is not None:
                self.begun = True
                # Rates and distances are measured from this time on.
                self.condition.close()
                self.condition.begin(world)
            holds = self.condition.holds()
        except UnknownNameError as error:
            if self.timeout is not None and now >= self.timeout - _TIME_ERROR:
                raise
            self._wait_for(error)
            return
        self._missing, self._known = None, True
        if self.when == "once":
            if holds:
                self._decide(True, now)
            elif self.timeout is not None and now >= self.timeout - _TIME_ERROR:
                self._decide(False, now)
        elif self.when == "always" and not holds and not isinstance(self.condition, Publishes):
            # A rate is only defined after some time.
            self._decide(False, now)

    def end(self, world: World) -> None:
        """Decides the condition at the end.

        Raises:
            UnknownNameError: A model, joint or topic does not exist.
        """
        if self._missing is not None:
            raise self._missing
        if self.met is None:
            holds = self.begun and self.condition.holds()
            self._decide(holds or (self.when == "always" and self.begun), world.time - self._start)
        self.condition.close()

    def _wait_for(self, error: UnknownNameError) -> None:
        """Waits for what does not exist, if it may be added."""
        if not self.patient or self._known:
            raise error
        self._missing = error

    def _decide(self, met: bool, now: float) -> None:
        self.met, self.time = met, now

    @property
    def open(self) -> bool:
        """Whether time must continue to decide the condition."""
        return self.met is None and self.when == "once"


def default_when(condition: Condition) -> When:
    """When a condition must be met if nothing is stated."""
    if isinstance(condition, StaysWithin):
        return "always"
    if isinstance(condition, Touches):
        return "always" if condition.inverted else "once"
    if isinstance(condition, Publishes) and condition.rate is not None:
        return "end"
    return "once"


def interval(world: World, watches: Iterable[Watch], sampling: float = SAMPLING) -> float:
    """Interval of simulation time in which conditions are evaluated, s."""
    if any(watch.condition.every_step and watch.met is None for watch in watches):
        return world.session.simulation.step_ns * 1e-9
    return sampling


def run(
    world: World,
    watches: list[Watch],
    seconds: float,
    *,
    until: Callable[[], bool] = lambda: False,
    sampling: float = SAMPLING,
    advance: Callable[[float], None] | None = None,
    looked: Callable[[], None] = lambda: None,
) -> None:
    """Runs a world and evaluates conditions.

    Args:
        world: The world.
        watches: The conditions.
        seconds: Maximum simulation time, s.
        until: Whether to end earlier; called after each evaluation.
        sampling: Interval in which conditions are evaluated, s.
        advance: Runs the world for a time; `World.run` by default.
        looked: Called after each evaluation.
    """
    advance = advance or world.run
    end = world.time + seconds
    while world.time < end - _TIME_ERROR and not until():
        advance(min(interval(world, watches, sampling), end - world.time))
        for watch in watches:
            watch.look(world)
        looked()
