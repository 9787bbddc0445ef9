"""Steps, conditions and timed actions of a world."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Self

from cartwheel.api.arguments import refused
from cartwheel.api.conditions import Condition
from cartwheel.api.running import RunningWorld
from cartwheel.api.values import Moment, moment_ns
from cartwheel.codes.world import NUMBER_OUT_OF_RANGE, WAIT_TIMED_OUT
from cartwheel.errors import CartwheelError, TimedOutError, Value
from cartwheel.simulation import RunState, Simulation
from cartwheel.simulation.alarms import Alarm
from cartwheel.simulation.clock import NANOSECONDS
from cartwheel.simulation.limits import check_steps, duration_ns, rate_period_ns

TIMEOUT = 60.0
"""Default simulation time for which a program waits, s."""


class Timer:
    """A pending action of `World.on` or `World.every`."""

    def __init__(self, alarm: Alarm) -> None:
        self._alarm = alarm

    @property
    def time(self) -> float:
        """Simulation time of the action, s: of the next one, if it is repeated."""
        return self._alarm.time_ns / NANOSECONDS

    @property
    def pending(self) -> bool:
        """Whether the action will run: it has not run, and was not cancelled."""
        return self._alarm.pending

    def cancel(self) -> None:
        """Cancels the action. Does nothing if it has run."""
        self._alarm.cancel()


class TimedWorld(RunningWorld):
    """The part of `World` that advances by steps and until conditions, and schedules actions."""

    _advancer: Callable[[float], None] | None = None
    """Advances the world by a time, s, in lockstep with another program; see `World.lockstep`."""

    def run(self, seconds: float, *, speed: float | None = None) -> None:
        """Advances the simulation. Without connections, nothing else can change it meanwhile.

        When the method returns, everything that is due at the new time has been published, and
        drives have executed the commands that they had received. Two runs of 0.5 s give the same
        results and messages as one run of 1 s.

        Ctrl-C completes the current step, so that a later call can continue.

        Args:
            seconds: Simulation time, at least 0. If a client, callback or action resets the
                simulation, it starts again.
            speed: Target real-time factor; None is that of `pace`, by default as fast as
                possible.

        Raises:
            CartwheelError: `seconds` or `speed` is out of range.
            SimulationError: The simulation diverged, the world is closed, a callback of the same
                world called the method, or the process was forked while the world was connected.
            RecordingError: A recording has failed.
            KeyboardInterrupt: Ctrl-C was pressed.
        """
        duration = duration_ns(seconds)
        if self._advancer is not None and duration:
            self._advancer(seconds)
        else:
            self._run_freely(duration, speed)

    @property
    def step_size(self) -> float:
        """Time step of the physics, s: that of the world file, or set by a client."""
        return self.session.simulation.step_ns / NANOSECONDS

    def step(self, n: int = 1) -> None:
        """Advances the simulation by time steps; otherwise like `run`.

        Args:
            n: Number of steps, at least 1.

        Raises:
            CartwheelError: `n` is out of range.
            SimulationError: See `run`.
        """
        check_steps(n)
        if self._advancer is not None:
            self._advancer(n * self.step_size)
            return
        with self._run() as simulation, self._driver.interruptible() as interruption:
            self._advance(simulation, n * simulation.step_ns, None)
        interruption.raise_pressed()

    def run_until(
        self,
        condition: Callable[[], object] | Callable[[Self], object],
        *,
        timeout: float = TIMEOUT,
        period: float | None = None,
        speed: float | None = None,
    ) -> None:
        """Advances the simulation until a condition holds.

        The condition is evaluated at the current time, and then after each step. If it holds at
        once, no time passes. `stop` ends the method without an error.

        Args:
            condition: Returns a true value when it holds. Takes no arguments, or the world. Its
                errors are raised after the step.
            timeout: Maximum simulation time, s.
            period: Simulation time between two evaluations, s; None for one step.
            speed: Target real-time factor; None is as fast as possible.

        Raises:
            TimedOutError: The condition does not hold within the time. The error contains the
                condition and, for a lambda, the values that it compares.
            CartwheelError: An argument is out of range.
            SimulationError: See `run`.
        """
        __tracebackhide__ = True
        tested = Condition(condition, self)
        if self._until(tested.holds, timeout=timeout, period=period, speed=speed):
            return
        time = self.session.simulation.time_ns / NANOSECONDS
        values = tested.values()
        shown = "; ".join(f"{name} is {value}" for name, value in values.items())
        raise timed_out(
            f"the condition `{tested.text}` did not hold within {timeout:g} s "
            f"(at {time:.9g} s{f': {shown}' if shown else ''})",
            {"condition": tested.text, "timeout": timeout, "time": time, **values},
        )

    def _until(
        self,
        holds: Callable[[], bool],
        *,
        timeout: float,
        period: float | None = None,
        speed: float | None = None,
    ) -> bool:
        """Runs until a condition holds, or `stop`. Returns False after the timeout."""
        limit = duration_ns(timeout, "the timeout in s")
        pause = None if period is None else duration_ns(period, "the period in s")
        if pause == 0:
            raise CartwheelError(
                f"the period in s must be above 0 (got {period:g})",
                code=NUMBER_OUT_OF_RANGE,
                hint="None evaluates the condition after each step.",
                values={"name": "the period in s", "value": float(period or 0.0)},
            )
        if self._advancer is not None:
            return self._until_in_lockstep(holds, limit, pause)
        with self._run() as simulation, self._driver.interruptible() as interruption:
            held = self._run_until(simulation, holds, limit, pause, speed)
        interruption.raise_pressed()
        return held

    def _until_in_lockstep(self, holds: Callable[[], bool], limit: int, pause: int | None) -> bool:
        assert self._advancer is not None
        simulation = self.session.simulation
        end = simulation.time_ns + limit
        while not holds():
            left = end - simulation.time_ns
            if left <= 0:
                return False
            step = simulation.step_ns
            self._advancer(min(max(pause or step, step), max(left, step)) / NANOSECONDS)
        return True

    def _run_until(
        self,
        simulation: Simulation,
        holds: Callable[[], bool],
        limit: int,
        pause: int | None,
        speed: float | None,
    ) -> bool:
        engine = simulation.engine
        end, rewinds = simulation.time_ns + limit, engine.rewinds
        while not holds() and simulation.run_state is not RunState.STOPPED:
            if engine.rewinds != rewinds:
                # As in `run`, the time starts again.
                end, rewinds = simulation.time_ns + limit, engine.rewinds
            left = end - simulation.time_ns
            if left <= 0:
                return False
            step = simulation.step_ns
            self._advance(simulation, min(max(pause or step, step), max(left, step)), speed)
        return True

    def on(self, time: Moment, action: Callable[[], Any]) -> Timer:
        """Runs an action once, at a simulation time, before the step that starts there.

        Due devices run after the action, so that a command acts in the same step. Actions at the
        same time run in the order in which they were added. An exception in the action stops `run`
        after the step, as in `subscribe`. `reset` removes all pending actions.

        Args:
            time: Simulation time, s, or the stamp of a message. A time within a step is handled at
                the next step.
            action: Is called without arguments.

        Returns:
            A handle that cancels the action.

        Raises:
            CartwheelError: The time has passed, or is out of range, or `action` is not a function.
            SimulationError: The world is closed.
        """
        due = moment_ns(time)
        action = _function(action)
        with self._used() as simulation:
            if due < simulation.time_ns:
                now = simulation.time_ns / NANOSECONDS
                raise CartwheelError(
                    f"the time must not be before {now:.9g} s (got {due / NANOSECONDS:.9g} s)",
                    code=NUMBER_OUT_OF_RANGE,
                    values={"name": "time", "value": due / NANOSECONDS, "now": now},
                )
            return Timer(simulation.alarms.add(Alarm(_guarded(action, simulation), due)))

    def every(self, rate: float, action: Callable[[], Any]) -> Timer:
        """Runs an action at a rate from now on, such as to move an obstacle along a path.

        It runs before the steps, as an action of `on` does. `reset` starts it again, and `cancel`
        of the handle ends it.

        Args:
            rate: Hz of simulation time; at most once in each step.
            action: Is called without arguments.

        Raises:
            CartwheelError: The rate is out of range, or `action` is not a function.
            SimulationError: The world is closed.
        """
        period = rate_period_ns(rate)
        action = _function(action)
        with self._used() as simulation:
            alarm = Alarm(_guarded(action, simulation), simulation.time_ns, period)
            return Timer(simulation.alarms.add(alarm))


def _function(action: Callable[[], Any]) -> Callable[[], Any]:
    if not callable(action):
        raise refused("action", "a function", action)
    return action


def _guarded(action: Callable[[], Any], simulation: Simulation) -> Callable[[], None]:
    def guarded() -> None:
        try:
            action()
        except BaseException as error:  # noqa: BLE001 - raised by `run`
            simulation.faults.defer(error)

    return guarded


def timed_out(message: str, values: dict[str, Value], hint: str | None = None) -> TimedOutError:
    """The error for something that did not happen in time."""
    return TimedOutError(message, code=WAIT_TIMED_OUT, values=values, hint=hint)
