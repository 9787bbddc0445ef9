"""Runs a simulation against the wall clock, and shows its state to listeners."""

from __future__ import annotations

import queue
import time
from collections import deque
from collections.abc import Callable

from cartwheel.simulation.clock import NANOSECONDS
from cartwheel.simulation.simulation import Simulation
from cartwheel.simulation.snapshot import RunState, Snapshot

_PATIENCE = 0.25
"""s of wall time that a slow simulation may lag before the lag is given up."""
_SLICE = 0.01
"""s of wall time between two looks at the clock while running as fast as possible."""
_WINDOW = 1.0
"""s of wall time over which the real-time factor is measured."""

Listener = Callable[[Snapshot], None]


class _Frames:
    """A listener and when it sees the next snapshot."""

    def __init__(self, listener: Listener, rate: float) -> None:
        self.listener = listener
        self.period = 1.0 / rate
        self.due = 0.0


class Pacer:
    """Steps a simulation at its wanted speed; on the thread that owns it.

    Pacing and listeners change nothing of what is simulated: only when.

    Args:
        simulation: To run.
        until_ns: Simulation time at which the run ends; None never.
    """

    def __init__(self, simulation: Simulation, *, until_ns: int | None = None) -> None:
        self._simulation = simulation
        self._until_ns = until_ns
        self._frames: tuple[_Frames, ...] = ()
        self._history: deque[tuple[float, int]] = deque()
        self._anchored: float | None = None
        """The speed from whose setting on time is counted; None when it must be counted anew."""
        simulation.on_reset.append(self._restart)

    def add_listener(self, listener: Listener, *, rate: float = 30.0) -> None:
        """Calls `listener` with a snapshot at `rate` Hz of wall time, on the owner's thread.

        It must return at once: hand the snapshot to another thread.
        """
        self._frames += (_Frames(listener, rate),)

    def _restart(self) -> None:
        self._history.clear()
        self._anchored = None

    def run(self) -> None:
        """Runs until the time is reached or the simulation is stopped.

        Raises:
            SimulationError: The simulation diverged.
        """
        simulation = self._simulation
        anchor_wall, anchor_ns, self._anchored = time.perf_counter(), simulation.time_ns, None
        while simulation.run_state is not RunState.STOPPED:
            if self._until_ns is not None and simulation.time_ns >= self._until_ns:
                break
            simulation.drain()
            now = time.perf_counter()
            speed = simulation.speed
            if simulation.run_state is RunState.PAUSED:
                if simulation.steps_allowed:
                    simulation.advance(
                        simulation.time_ns + simulation.steps_allowed * simulation.step_ns
                    )
                self._history.clear()
                simulation.real_time_factor = 0.0
                self._show(now)
                self._wait(self._next_frame(now + 0.1) - time.perf_counter())
                self._anchored = None
                continue
            if simulation.run_state is RunState.STOPPED:
                break
            goal_ns = now_ns = simulation.time_ns
            if speed is None:
                # As many steps as fit into a slice at the speed of late; then look again.
                goal_ns += max(
                    simulation.step_ns,
                    int(_SLICE * NANOSECONDS * max(simulation.real_time_factor, 1.0)),
                )
            else:
                wanted = anchor_ns + int((now - anchor_wall) * speed * NANOSECONDS)
                lag = (wanted - now_ns) / NANOSECONDS / speed
                if speed != self._anchored or lag > _PATIENCE or lag < -_PATIENCE:
                    anchor_wall, anchor_ns, self._anchored = now, now_ns, speed
                    wanted = now_ns + simulation.step_ns
                goal_ns = wanted
            if self._until_ns is not None:
                goal_ns = min(goal_ns, self._until_ns)
            if goal_ns > now_ns:
                # A slow simulation still looks at the clock, the commands and the listeners.
                limit = max(simulation.step_ns, int(0.05 * NANOSECONDS))
                simulation.advance(min(goal_ns, now_ns + limit if speed is not None else goal_ns))
            now = time.perf_counter()
            self._measure(now)
            self._show(now)
            if speed is not None:
                ahead = (simulation.time_ns + simulation.step_ns - anchor_ns) / NANOSECONDS / speed
                self._wait(min(anchor_wall + ahead, self._next_frame(now + 0.1)) - now)

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

    def _wait(self, seconds: float) -> None:
        """Sleeps, unless a command comes."""
        if seconds <= 0:
            return
        try:
            command = self._simulation.commands.get(timeout=seconds)
        except queue.Empty:
            return
        command()
