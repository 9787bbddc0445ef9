"""Whether time goes on and how fast, and what other threads ask of the one that owns it."""

from __future__ import annotations

import math
import queue
import threading
import time
from collections.abc import Callable
from concurrent.futures import Future
from typing import TypeVar

from cartwheel.calls import answered
from cartwheel.codes import world as world_codes
from cartwheel.errors import SimulationError
from cartwheel.simulation.limits import check_speed
from cartwheel.simulation.snapshot import RunState

T = TypeVar("T")


class Run:
    """Something that goes on in time, owned by one thread.

    The owner alone calls its methods; others use `post` and `call`.
    """

    def __init__(self) -> None:
        self.run_state = RunState.RUNNING
        self.speed: float | None = 1.0
        """The wanted real-time factor; None is as fast as it can."""
        self.real_time_factor = 0.0
        """Measured; 0 while paused."""
        self.steps_allowed: int | None = None
        """Steps until a paused run pauses again; None while it is not stepping singly."""
        self.on_reset: list[Callable[[], None]] = []
        """Called after time went back to the start."""
        self.owner: int | None = None
        """The thread that ran it last; None while none has."""
        self.closed = False
        """Whether it has ended for good."""
        self.command_time = math.inf
        """s of wall time that posted functions may take before time goes on. A pacer bounds it:
        threads that post without a pause would hold time."""
        self.commands: queue.SimpleQueue[Callable[[], None]] = queue.SimpleQueue()

    def pause(self) -> None:
        """Holds time."""
        if self.run_state is RunState.RUNNING:
            self.run_state = RunState.PAUSED
            self.steps_allowed = None

    def resume(self) -> None:
        """Lets time go on."""
        if self.run_state is RunState.PAUSED:
            self.run_state = RunState.RUNNING
            self.steps_allowed = None

    def stop(self) -> None:
        """Ends the run, also where it sleeps; from any thread."""
        self.run_state = RunState.STOPPED
        self.post(lambda: None)

    def set_speed(self, speed: float | None) -> None:
        """Sets the wanted real-time factor; None is as fast as it can.

        Raises:
            CartwheelError: It is outside of `limits.SLOWEST` and `limits.FASTEST`.
        """
        check_speed(speed)
        self.speed = speed

    def post(self, function: Callable[[], None]) -> None:
        """Runs a function on the owner's thread, before the next step; from any thread.

        Nothing is run after the end.
        """
        if not self.closed:
            self.commands.put(function)

    def call(self, function: Callable[[], T]) -> Future[T]:
        """Like `post`, with the result or the error; from any thread.

        Raises:
            SimulationError: It has ended for good.
        """
        if self.closed:
            raise SimulationError("the simulation is closed", code=world_codes.SIMULATION_CLOSED)
        return answered(self.post, function)

    def end(self) -> None:
        """Takes no commands any more, and calls nobody; those that came last are run."""
        self.closed = True
        self.command_time = math.inf
        self.drain()
        self.on_reset.clear()

    def drain(self) -> None:
        """Runs what other threads posted, for `command_time` at most."""
        self.owner = threading.get_ident()
        end = time.perf_counter() + self.command_time
        while not self.commands.empty():
            self._obey(self.commands.get())
            if time.perf_counter() >= end:
                return

    def wait(self, seconds: float) -> None:
        """Sleeps, unless something is posted, which is run."""
        if seconds <= 0:
            return
        try:
            command = self.commands.get(timeout=seconds)
        except queue.Empty:
            return
        self._obey(command)

    def command_failed(self, error: Exception) -> None:
        """What to do about a posted function that raised an error."""
        raise error

    def _obey(self, command: Callable[[], None]) -> None:
        try:
            command()
        except Exception as error:  # noqa: BLE001 - another thread's code
            self.command_failed(error)
