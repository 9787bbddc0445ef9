"""Runs a simulation against the wall clock and passes its state to listeners."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass

from cartwheel.errors import DivergedError
from cartwheel.simulation.clock import NANOSECONDS
from cartwheel.simulation.simulation import Simulation
from cartwheel.simulation.snapshot import RunState, Snapshot

_PATIENCE = 0.25
"""Wall time by which a simulation may lag before the lag is dropped, s."""
_COMMANDS = 0.05
"""Maximum wall time for commands from other threads between two steps, s."""
_SLICE = 0.01
"""Wall time between two looks at the clock while running as fast as possible, s."""
_WINDOW = 1.0
"""Wall time over which the real-time factor is measured, s."""

_LONGEST_TURN_NS = 50_000_000
"""Maximum simulation time per iteration while paced."""

Listener = Callable[[Snapshot], None]


class _Frames:
    """A listener and the time of its next snapshot."""

    def __init__(self, listener: Listener, rate: float) -> None:
        self.listener = listener
        self.period = 1.0 / rate
        self.due = 0.0


@dataclass(frozen=True, slots=True)
class _Anchor:
    """The wall time and simulation time from which a speed is measured."""

    wall: float
    time_ns: int
    speed: float

    def time_at(self, wall: float) -> int:
        """The simulation time due at a wall time."""
        return self.time_ns + int((wall - self.wall) * self.speed * NANOSECONDS)

    def wall_at(self, time_ns: int) -> float:
        """The wall time at which a simulation time is due."""
        return self.wall + (time_ns - self.time_ns) / NANOSECONDS / self.speed


class Pacer:
    """Steps a simulation at its target speed. Use it on the thread that owns the simulation.

    Pacing and listeners never change the simulation results.

    Args:
        simulation: The simulation to run.
        until_ns: Simulation time at which to stop; None runs until stopped.
        strict: Stop at the first divergence, even if `Simulation.recover` could continue.
    """

    def __init__(
        self, simulation: Simulation, *, until_ns: int | None = None, strict: bool = False
    ) -> None:
        self._simulation = simulation
        self._strict = strict
        self.until_ns = until_ns
        self._frames: tuple[_Frames, ...] = ()
        self._history: deque[tuple[float, int]] = deque()
        self._anchor: _Anchor | None = None
        simulation.on_reset.append(self._restart)

    def add_listener(self, listener: Listener, *, rate: float = 30.0) -> None:
        """Calls `listener` with snapshots at `rate` Hz of wall time, on the owner's thread.

        The listener must return at once, for example by passing the snapshot to another thread.
        """
        self._frames += (_Frames(listener, rate),)

    def run(self) -> None:
        """Runs until the target time is reached or the simulation is stopped.

        Raises:
            SimulationError: The simulation diverged without any external action.
        """
        simulation = self._simulation
        simulation.command_time = _COMMANDS
        turns = {RunState.RUNNING: self._run_on, RunState.PAUSED: self._hold}
        while True:
            simulation.drain()
            ended = self.until_ns is not None and simulation.time_ns >= self.until_ns
            turn = turns.get(simulation.run_state)
            if ended or turn is None:
                return
            turn()

    def show(self) -> None:
        """Passes the current state to the listeners at once."""
        if self._frames:
            snapshot = self._simulation.snapshot()
            for frames in self._frames:
                frames.listener(snapshot)

    def _run_on(self) -> None:
        """One iteration while running: steps, listeners, sleep."""
        simulation = self._simulation
        now_ns = simulation.time_ns
        anchor = self._anchored(time.perf_counter())
        if anchor is None:
            # Run the steps that fit into a slice at the recent speed, then look at the clock again.
            speed = max(simulation.real_time_factor, 1.0)
            goal_ns = now_ns + max(simulation.step_ns, int(_SLICE * NANOSECONDS * speed))
        else:
            # A slow simulation must still handle the clock, commands and listeners.
            goal_ns = min(anchor.time_at(time.perf_counter()), now_ns + _LONGEST_TURN_NS)
        if self.until_ns is not None:
            goal_ns = min(goal_ns, self.until_ns)
        if goal_ns > now_ns:
            self._advance(goal_ns)
        now = time.perf_counter()
        self._measure(now)
        self._show(now)
        anchor = self._anchor
        if anchor is not None:
            next_step = anchor.wall_at(simulation.time_ns + simulation.step_ns)
            simulation.wait(min(next_step, self._next_frame(now + 0.1)) - now)

    def _hold(self) -> None:
        """One iteration while paused: requested single steps, listeners, sleep."""
        simulation = self._simulation
        if simulation.steps_allowed:
            # Split long requests into several iterations, so that listeners see the progress.
            most_ns = max(simulation.step_ns, _LONGEST_TURN_NS)
            wanted_ns = simulation.steps_allowed * simulation.step_ns
            self._advance(simulation.time_ns + min(wanted_ns, most_ns))
        self._restart()
        simulation.real_time_factor = 0.0
        now = time.perf_counter()
        self._show(now)
        if simulation.steps_allowed:
            return
        simulation.wait(self._next_frame(now + 0.1) - time.perf_counter())

    def _advance(self, goal_ns: int) -> None:
        simulation = self._simulation
        try:
            simulation.advance(goal_ns)
        except DivergedError as error:
            if self._strict or not simulation.recover(error):
                raise

    def _anchored(self, now: float) -> _Anchor | None:
        """The pacing anchor, reset after a speed change or a lag; None without a target speed."""
        simulation, anchor = self._simulation, self._anchor
        if simulation.speed is None:
            self._anchor = None
        else:
            # In slow motion, two steps may exceed the default patience.
            patience = max(_PATIENCE, 2 * simulation.step_ns / NANOSECONDS / simulation.speed)
            if (
                anchor is None
                or anchor.speed != simulation.speed
                or abs(anchor.wall_at(simulation.time_ns) - now) > patience
            ):
                self._anchor = _Anchor(now, simulation.time_ns, simulation.speed)
        return self._anchor

    def _restart(self) -> None:
        self._history.clear()
        self._anchor = None

    def _measure(self, now: float) -> None:
        history = self._history
        history.append((now, self._simulation.time_ns))
        while len(history) > 2 and now - history[1][0] >= _WINDOW:
            history.popleft()
        wall = now - history[0][0]
        if wall > 0.05:
            passed = (self._simulation.time_ns - history[0][1]) / NANOSECONDS
            self._simulation.real_time_factor = passed / wall

    def _next_frame(self, latest: float) -> float:
        return min([latest, *(frames.due for frames in self._frames)])

    def _show(self, now: float) -> None:
        snapshot = None
        for frames in self._frames:
            if now >= frames.due:
                frames.due = max(frames.due + frames.period, now)
                snapshot = snapshot or self._simulation.snapshot()
                frames.listener(snapshot)
