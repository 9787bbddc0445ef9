"""Runs a simulation for a program: for a time, or until it is stopped."""

from __future__ import annotations

import contextlib
import importlib
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from types import FrameType
from typing import Any, Self

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

    def interruptible(self) -> Interruption:
        """Lets Ctrl-C stop the run after the current step."""
        return Interruption(self._simulation.stop)


class Interruption:
    """Calls a function at Ctrl-C during the block; a second Ctrl-C raises at once.

    Programs with their own signal handler, and threads, are not affected. A block within another
    one leaves Ctrl-C to the outer block.

    Args:
        action: Called at Ctrl-C.
    """

    __slots__ = ("_action", "_installed", "pressed")

    def __init__(self, action: Callable[[], None]) -> None:
        self._action = action
        self._installed = False
        self.pressed = False
        """Whether Ctrl-C was pressed."""

    def __enter__(self) -> Self:
        self._installed = (
            threading.get_ident() == threading.main_thread().ident
            and _handler(_INTERRUPT) is _usual
        )
        if self._installed:
            _set_handler(_INTERRUPT, self._stop)
        return self

    def __exit__(self, *_: object) -> None:
        if self._installed:
            _set_handler(_INTERRUPT, _usual)

    def raise_pressed(self) -> None:
        """Raises the interruption of the block, after it.

        Raises:
            KeyboardInterrupt: Ctrl-C was pressed.
        """
        if self.pressed:
            raise KeyboardInterrupt

    def _stop(self, _number: int, _frame: FrameType | None) -> None:
        _set_handler(_INTERRUPT, _usual)
        self.pressed = True
        self._action()


@contextlib.contextmanager
def uninterrupted() -> Iterator[None]:
    """Completes the block before Ctrl-C raises a KeyboardInterrupt."""
    interruption = Interruption(lambda: None)
    try:
        with interruption:
            yield
    finally:
        interruption.raise_pressed()


_INTERRUPT = int(signal.SIGINT)
_IS_CPYTHON = sys.implementation.name == "cpython"
_usual = signal.default_int_handler
# The functions of the module `signal` convert handlers to enumerations, which takes most of their
# time.
_functions: Any = importlib.import_module("_signal" if _IS_CPYTHON else "signal")
_handler, _set_handler = _functions.getsignal, _functions.signal
