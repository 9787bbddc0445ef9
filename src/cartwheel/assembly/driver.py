"""Runs a simulation for a program: for a time, or until it is stopped."""

from __future__ import annotations

import contextlib
import signal
import threading
from collections.abc import Callable, Iterator
from types import FrameType

from cartwheel.assembly.turns import Turns
from cartwheel.simulation import RunState, Simulation
from cartwheel.simulation.pacing import Pacer


class Driver:
    """Runs a simulation on the calling thread, which must have its turn.

    Args:
        simulation: The simulation.
        turns: Held while a thread uses the simulation.
    """

    def __init__(self, simulation: Simulation, turns: Turns) -> None:
        self._simulation = simulation
        self._turns = turns
        self._pacer: Pacer | None = None
        self._depth = 0
        self.connected = False
        """Whether the simulation has clients, which see that it waits between two runs."""

    @property
    def pacer(self) -> Pacer:
        """Runs the simulation; created when it is first used."""
        if self._pacer is None:
            # A program handles a divergence itself.
            self._pacer = Pacer(self._simulation, strict=True)
        return self._pacer

    def begin(self) -> None:
        """Starts a run."""
        if self._simulation.run_state in (RunState.WAITING, RunState.STOPPED):
            self._simulation.run_state = RunState.RUNNING

    def end(self) -> None:
        """Ends a run."""
        simulation = self._simulation
        if simulation.closed or not self.connected:
            return
        if simulation.run_state in (RunState.RUNNING, RunState.STOPPED):
            simulation.run_state = RunState.WAITING
        simulation.real_time_factor = 0.0
        self.pacer.show()

    def run(self, duration_ns: int | None, speed: float | None, *, shared: bool) -> None:
        """Runs until the time has passed or the simulation is stopped.

        When the time has passed, everything that is due has been published.

        Args:
            duration_ns: Simulation time; a reset starts it again. None has no limit.
            speed: Target real-time factor; None is as fast as possible.
            shared: Whether other threads may use the simulation between two steps.

        Raises:
            SimulationError: The simulation diverged.
        """
        simulation, pacer = self._simulation, self.pacer
        outer = pacer.until_ns, simulation.speed, simulation.command_time
        simulation.set_speed(speed)

        def restart() -> None:
            pacer.until_ns = duration_ns

        pacer.until_ns = None if duration_ns is None else simulation.time_ns + duration_ns
        simulation.on_reset.append(restart)
        sharing = self._turns.shared(simulation.post) if shared else contextlib.nullcontext()
        self._depth += 1
        try:
            simulation.drain_queued()
            with sharing:
                pacer.run()
            if pacer.until_ns is not None and simulation.time_ns >= pacer.until_ns:
                simulation.complete()
        finally:
            self._depth -= 1
            pacer.until_ns, speed_before, simulation.command_time = outer
            if self._depth:
                # Another thread's run, which lets this thread in, continues at its own speed.
                simulation.set_speed(speed_before)
            if restart in simulation.on_reset:
                simulation.on_reset.remove(restart)

    @contextlib.contextmanager
    def interruptible(self) -> Iterator[threading.Event]:
        """Lets Ctrl-C stop the run after the current step.

        Yields:
            An event that is set after Ctrl-C.
        """
        with _delayed_interrupt(self._simulation.stop) as pressed:
            yield pressed


@contextlib.contextmanager
def uninterrupted() -> Iterator[None]:
    """Completes the block before Ctrl-C raises a KeyboardInterrupt."""
    pressed = threading.Event()
    try:
        with _delayed_interrupt(lambda: None) as pressed:
            yield
    finally:
        if pressed.is_set():
            raise KeyboardInterrupt


@contextlib.contextmanager
def _delayed_interrupt(action: Callable[[], None]) -> Iterator[threading.Event]:
    """Calls a function at Ctrl-C; a second Ctrl-C raises at once.

    Programs with their own signal handler, and threads, are not affected.

    Yields:
        An event that is set after Ctrl-C.
    """
    pressed = threading.Event()
    usual = signal.default_int_handler
    main = threading.current_thread() is threading.main_thread()
    if not main or signal.getsignal(signal.SIGINT) is not usual:
        yield pressed
        return

    def stop(_number: int, _frame: FrameType | None) -> None:
        signal.signal(signal.SIGINT, usual)
        pressed.set()
        action()

    signal.signal(signal.SIGINT, stop)
    try:
        yield pressed
    finally:
        signal.signal(signal.SIGINT, usual)
