"""The run state and speed of a simulation, and requests from other threads to its owner."""

from __future__ import annotations

import math
import queue
import threading
import time
from collections import deque
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
    """A process in simulation time, owned by one thread.

    Only the owner calls its methods; other threads use `post` and `call`.
    """

    def __init__(self) -> None:
        self.run_state = RunState.RUNNING
        self.speed: float | None = 1.0
        """The target real-time factor; None is as fast as possible."""
        self.real_time_factor = 0.0
        """The measured real-time factor; 0 while paused."""
        self.steps_allowed: int | None = None
        """Steps until the run pauses again; None if it is not single-stepping."""
        self.on_reset: list[Callable[[], None]] = []
        """Called after time was reset."""
        self.owner: int | None = None
        """The thread that ran it last; None if none has."""
        self.closed = False
        """Whether it is closed permanently."""
        self.command_time = math.inf
        """Maximum wall time for posted functions between steps, s. Pacers limit it, because threads
        that post continuously would stop simulation time.
        """
        self.commands: queue.SimpleQueue[Callable[[], None]] = queue.SimpleQueue()
        self.attendant: Callable[[], None] | None = None
        """Makes another thread call `serve_reads` as soon as no thread runs the simulation; None if
        functions that only read wait like all others.
        """
        self._reads: deque[Callable[[], None]] = deque()
        self._read_posted = False

    def pause(self) -> None:
        """Pauses the simulation."""
        if self.run_state is RunState.RUNNING:
            self.run_state = RunState.PAUSED
            self.steps_allowed = None

    def resume(self) -> None:
        """Resumes the simulation."""
        if self.run_state is RunState.PAUSED:
            self.run_state = RunState.RUNNING
            self.steps_allowed = None

    def stop(self) -> None:
        """Stops the run, even while it sleeps. Thread-safe."""
        self.run_state = RunState.STOPPED
        self.post(lambda: None)

    def set_speed(self, speed: float | None) -> None:
        """Sets the target real-time factor; None is as fast as possible.

        Raises:
            CartwheelError: The factor is outside `limits.SLOWEST` to `limits.FASTEST`.
        """
        check_speed(speed)
        self.speed = speed

    def post(self, function: Callable[[], None]) -> None:
        """Queues a function for the owner's thread, to run before the next step. Thread-safe.

        Nothing runs after the run was closed.
        """
        if not self.closed:
            self.commands.put(function)

    def call(self, function: Callable[[], T]) -> Future[T]:
        """Like `post`, but returns a future for the result or error. Thread-safe.

        Raises:
            SimulationError: The run is closed.
        """
        if self.closed:
            raise SimulationError("the simulation is closed", code=world_codes.SIMULATION_CLOSED)
        return answered(self.post, function)

    def post_read(self, function: Callable[[], None]) -> None:
        """Like `post`, for a function that does not change the simulation. Thread-safe.

        It does not wait for the next run if there is an `attendant`.
        """
        if self.attendant is None:
            self.post(function)
        elif not self.closed:
            self._reads.append(function)
            if not self._read_posted:
                self._read_posted = True
                self.post(self._serve_posted)
            self.attendant()

    def read(self, function: Callable[[], T]) -> Future[T]:
        """Like `post_read`, but returns a future for the result or error. Thread-safe.

        Raises:
            SimulationError: The run is closed.
        """
        if self.closed:
            raise SimulationError("the simulation is closed", code=world_codes.SIMULATION_CLOSED)
        return answered(self.post_read, function)

    def serve_reads(self) -> None:
        """Runs the functions of `post_read`. No other thread may use the simulation meanwhile."""
        while self._reads:
            self._obey(self._reads.popleft())

    def _serve_posted(self) -> None:
        self._read_posted = False
        self.serve_reads()

    def end(self) -> None:
        """Closes the run: executes pending commands, then rejects new ones and removes all
        callbacks.
        """
        self.closed = True
        self.command_time = math.inf
        self.drain()
        self.serve_reads()
        self.attendant = None
        self.on_reset.clear()

    def drain(self) -> None:
        """Runs posted functions for at most `command_time`."""
        self.owner = threading.get_ident()
        commands, is_limited = self.commands, self.command_time < math.inf
        end = time.perf_counter() + self.command_time if is_limited else math.inf
        while not commands.empty():
            self._obey(commands.get())
            if is_limited and time.perf_counter() >= end:
                return

    def drain_queued(self) -> None:
        """Runs the functions that are queued now, without a limit of time."""
        self.owner = threading.get_ident()
        for _ in range(self.commands.qsize()):
            self._obey(self.commands.get())

    def wait(self, seconds: float) -> None:
        """Sleeps until the timeout; a posted function wakes it and is run."""
        if seconds <= 0:
            return
        try:
            command = self.commands.get(timeout=seconds)
        except queue.Empty:
            return
        self._obey(command)

    def command_failed(self, error: Exception) -> None:
        """Handles an error raised by a posted function."""
        raise error

    def _obey(self, command: Callable[[], None]) -> None:
        try:
            command()
        except Exception as error:  # noqa: BLE001 - another thread's code
            self.command_failed(error)
