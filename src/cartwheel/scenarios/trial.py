"""Runs a case: its steps, its conditions, and what is kept of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from cartwheel.errors import CartwheelError, Pickled
from cartwheel.scenarios.document import Document, Key
from cartwheel.scenarios.expectations import watch_of
from cartwheel.scenarios.outcome import Finding, Kind, Outcome
from cartwheel.testing.watching import SAMPLING, Watch, run

if TYPE_CHECKING:
    from cartwheel.api import World

UNTIL = 30.0
"""Default maximum simulation time of an ``until`` step, a call or a goal, s."""
TRACK = 0.1
"""Interval of the points of a trajectory, s."""
_MOST_POINTS = 1000
_STILL = 0.02
"""Movement in m that is not shown."""
_MOST_OBSTACLES = 100
_LOW = 0.02
"""Height in m of shapes that are no obstacles."""


class StepFailedError(Pickled, Exception):
    """A step that did not succeed.

    Args:
        expected: What was expected.
        actual: What was observed.
        values: The observed values.
    """

    def __init__(self, expected: str, actual: str, values: Mapping[str, Any]) -> None:
        super().__init__(expected)
        self.expected, self.actual, self.values = expected, actual, values


class Trial:
    """A case that runs in a world.

    Args:
        world: The world with its robots.
        document: The scenario, for the places of findings.
        value: The scenario with the values of the case.
        outcome: Receives the results.
        advance: Runs the world for a time; `World.run` by default.
    """

    def __init__(
        self,
        world: World,
        document: Document,
        value: Mapping[str, Any],
        outcome: Outcome,
        *,
        advance: Callable[[float], None] | None = None,
    ) -> None:
        self.world, self.value = world, value
        self._document, self._outcome = document, outcome
        self._advance = advance
        self._sampling = value.get("sampling", SAMPLING)
        self._watches: list[Watch] = []
        self._extra: list[Watch] = []
        self._tracked = [each for each in world.models if world.session.simulation.moves(each)]
        self._due = 0.0
        self._track = TRACK
        self.start = world.time
        self.ends: list[Callable[[], None]] = []
        """Called at the end."""

    def run(self, steps: Callable[[Trial, Mapping[str, Any]], None]) -> None:
        """Runs the case.

        Args:
            steps: Performs a step.
        """
        key: Key = ()
        try:
            for index, each in enumerate(self.value["expect"]):
                key = ("expect", index)
                watch = watch_of(each)
                watch.origin = self._document.origin(key)
                watch.patient = any("spawn" in step for step in self.value.get("steps", ()))
                self._watches.append(watch)
                watch.begin(self.world)
            self._note()
            self.describe()
            for index, each in enumerate(self.value.get("steps", ())):
                key = ("steps", index)
                if self.decided:
                    break
                steps(self, each)
            key = ()
            self._finish()
            for index, watch in enumerate(self._watches):
                key = ("expect", index)
                watch.end(self.world)
                if not watch.met:
                    self._unmet(key, watch)
        except StepFailedError as failure:
            self._add("step", key, failure.expected, failure.actual, failure.values)
        except CartwheelError as error:
            self._error(key, error)
        finally:
            for watch in self._watches:
                watch.condition.close()
            for end in self.ends:
                end()
            self._outcome.time = self.now
            self._note(last=True)

    def describe(self) -> None:
        """Notes the obstacles and targets, for the report."""
        space = self.world.session.simulation.occupied()
        for low, high, fixed in zip(space.low, space.high, space.fixed, strict=True):
            if fixed and high[2] > _LOW and len(self._outcome.obstacles) < _MOST_OBSTACLES:
                box = (low[0], low[1], high[0], high[1])
                self._outcome.obstacles.append([round(float(each), 3) for each in box])
        for each in self.value["expect"]:
            if "reaches" in each and "x" in each and "y" in each:
                self._outcome.targets.append([each["x"], each["y"], each.get("within", 0.1)])

    @property
    def now(self) -> float:
        """Simulation time from the start of the case, s."""
        return self.world.time - self.start

    @property
    def decided(self) -> bool:
        """Whether a condition has failed for good, so that time need not continue."""
        return any(watch.met is False for watch in self._watches)

    def advance(self, seconds: float, until: Callable[[], bool] = lambda: False) -> None:
        """Runs the world and evaluates the conditions."""
        run(
            self.world,
            [*self._watches, *self._extra],
            seconds,
            until=lambda: self.decided or until(),
            sampling=self._sampling,
            advance=self._advance,
            looked=self._note,
        )

    def until(self, value: Mapping[str, Any], timeout: float) -> None:
        """Runs the world until a condition is met.

        Raises:
            StepFailedError: It was not met within the timeout.
        """
        watch = watch_of(value)
        watch.when, watch.timeout = "once", None
        try:
            watch.begin(self.world)
            self._extra.append(watch)
            self.advance(timeout, lambda: watch.met is not None)
            watch.end(self.world)
        finally:
            watch.condition.close()
            if watch in self._extra:
                self._extra.remove(watch)
        if not watch.met and not self.decided:
            condition = watch.condition
            raise StepFailedError(
                f"{condition.expected}, after at most {timeout:g} s",
                condition.actual,
                condition.values,
            )

    def _unmet(self, key: Key, watch: Watch) -> None:
        """Adds a finding for a condition that was not met."""
        condition, actual = watch.condition, watch.condition.actual
        if not watch.begun:
            actual = f"the case ended before the condition began at {watch.after:g} s"
        self._add("expectation", key, condition.expected, actual, condition.values, time=watch.time)

    def _add(
        self,
        kind: Kind,
        key: Key,
        expected: str,
        actual: str,
        values: Mapping[str, Any],
        *,
        time: float | None = None,
    ) -> None:
        origin = self._document.origin(key)
        self._outcome.findings.append(
            Finding(
                kind=kind, expected=expected, actual=actual, file=origin.file, line=origin.line,
                time=self.now if time is None else time, values=dict(values),
            )
        )  # fmt: skip
        if self._outcome.status == "passed":
            self._outcome.status = "failed"

    def _error(self, key: Key, error: CartwheelError) -> None:
        origin = error.origin or self._document.origin(key)
        self._outcome.status = "error"
        self._outcome.findings.append(
            Finding(
                kind="error", expected="", actual=error.message, file=origin.file,
                line=origin.line, time=self.now, code=error.code.number, hint=error.hint or "",
                values=dict(error.values),
            )
        )  # fmt: skip

    def _finish(self) -> None:
        """Runs until the duration has passed, or until all conditions are decided."""
        duration = self.value.get("duration")
        if duration is not None:
            self.advance(max(0.0, duration - self.now))
            return
        waiting = [watch for watch in self._watches if watch.open]
        if waiting:
            latest = max(
                self.now + UNTIL if watch.timeout is None else watch.timeout for watch in waiting
            )
            self.advance(
                max(0.0, latest - self.now), lambda: not any(watch.open for watch in waiting)
            )

    def _note(self, *, last: bool = False) -> None:
        """Adds a point to the trajectories."""
        now = self.now
        if not last and now < self._due - 1e-9:
            return
        self._due = now + self._track
        simulation = self.world.session.simulation
        simulation.refresh()
        for name in self._tracked:
            if name not in simulation.models:
                continue
            pose = simulation.pose(name)
            point = [round(each, 4) for each in (now, pose.x, pose.y, pose.yaw)]
            points = self._outcome.trajectories.setdefault(name, [])
            if last and points and points[-1][0] == point[0]:
                continue
            points.append(point)
            if len(points) > _MOST_POINTS:
                del points[1:-1:2]
        if any(len(points) > _MOST_POINTS - 2 for points in self._outcome.trajectories.values()):
            self._track *= 2
        if last:
            self._forget_still()

    def _forget_still(self) -> None:
        """Omits the trajectories of scenery that has not moved."""
        robots = self._tracked[len(self._tracked) - len(self.value.get("robots", ())) :]
        for name, points in list(self._outcome.trajectories.items()):
            _, x, y, _ = points[0]
            if name not in robots and all(
                abs(point[1] - x) < _STILL and abs(point[2] - y) < _STILL for point in points
            ):
                del self._outcome.trajectories[name]
