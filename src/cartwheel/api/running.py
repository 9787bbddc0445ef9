"""Time, connections and the end of a world."""

from __future__ import annotations

import contextlib
import threading
import time
from collections.abc import Iterator, Sequence
from types import TracebackType
from typing import TYPE_CHECKING, Literal, Self

from cartwheel.api.values import scalar
from cartwheel.assembly import at_exit
from cartwheel.assembly.driver import Driver, uninterrupted
from cartwheel.assembly.turn import Turn
from cartwheel.assembly.turns import Turns
from cartwheel.codes.world import RUN_NESTED, SIMULATION_CLOSED
from cartwheel.errors import CartwheelError, SimulationError
from cartwheel.session import Session
from cartwheel.simulation import RunState
from cartwheel.simulation.limits import duration_ns

if TYPE_CHECKING:
    from cartwheel.assembly.connections import Connections
    from cartwheel.assembly.plan import Plan
    from cartwheel.assembly.ros1 import Ros1Connection
    from cartwheel.assembly.ros2 import Ros2Connection
    from cartwheel.simulation import Simulation

_LOOK = 0.05
"""Interval of wall time in which `RunningWorld.wait_for_browser` looks for browsers, s."""


class RunningWorld:
    """The part of `World` that runs and connects a session.

    Args:
        session: The session.
        host: Address on which the viewer and the Foxglove server listen.
        allow_origin: Origins of web pages that may connect to them.
        connections: Prepared connections; None if there are none.
        plan: The connections to open.
    """

    def __init__(
        self,
        session: Session,
        *,
        host: str,
        allow_origin: Sequence[str],
        connections: Connections | None,
        plan: Plan | None,
    ) -> None:
        self.session = session
        self.lock = Turns()
        """Held while a thread uses the world."""
        self.pace: float | None = None
        """Real-time factor of runs without a `speed`; None is as fast as possible."""
        self._host, self._allow_origin = host, tuple(allow_origin)
        self._driver = Driver(session.simulation, self.lock)
        self._connections: Connections | None = None
        self._closing = self._ends_at_exit = False
        session.simulation.drain()  # this thread is the owner
        if connections is not None and plan is not None:
            with self.lock:
                self._attach(connections, ros1=plan.ros1 is not None)
                connections.open(plan)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        try:
            self.close()
        except CartwheelError as failure:
            if error is None:
                raise
            error.add_note(str(failure))

    def _check_open(self) -> None:
        """Refuses the use of a closed world.

        Raises:
            SimulationError: The world is closed.
        """
        if self.session.simulation.closed:
            raise SimulationError("the world is closed", code=SIMULATION_CLOSED)

    @contextlib.contextmanager
    def _used(self, *, change: bool = False) -> Iterator[Simulation]:
        """Exclusive access to the simulation for this thread.

        Args:
            change: Whether the block changes the models. Ctrl-C then takes effect after the block.

        Raises:
            SimulationError: The world is closed, or is connected and belongs to the parent process.
        """
        with self.lock:
            self._check_open()
            simulation = self.session.simulation
            with uninterrupted() if change else contextlib.nullcontext():
                try:
                    yield simulation
                finally:
                    if change:
                        simulation.engine.note_change()
                    if self._connections is not None and self.lock.runner is None:
                        self._connections.update()
                        self._driver.pacer.show()

    # -- time

    def _run_freely(self, duration_ns: int, speed: float | None = None) -> None:
        """`run`, without lockstep."""
        with self._run() as simulation, self._driver.interruptible() as interruption:
            self._advance(simulation, duration_ns, speed)
        interruption.raise_pressed()

    def _advance(self, simulation: Simulation, duration_ns: int, speed: float | None) -> None:
        """Runs for a simulation time within `_run`, or until the run is stopped."""
        if speed is None and not self._is_paced:
            rewinds = None
            while rewinds != simulation.engine.rewinds:
                rewinds, target = simulation.engine.rewinds, simulation.time_ns + duration_ns
                simulation.advance(target)
                if simulation.run_state is RunState.STOPPED:
                    return
            if simulation.time_ns >= target:
                simulation.complete()
        else:
            self._driver.run(duration_ns, self.pace if speed is None else speed, shared=False)

    def spin(self, seconds: float | None = None, *, speed: float | None = 1.0) -> None:
        """Runs the simulation in real time until `stop`, Ctrl-C or a time limit.

        Other threads can use the world meanwhile, between two steps. Ctrl-C completes the current
        step. Without a time limit, the method then returns.

        Args:
            seconds: Simulation time, at least 0; None has no limit.
            speed: Target real-time factor; None is as fast as possible.

        Raises:
            CartwheelError: `seconds` or `speed` is out of range.
            SimulationError: The simulation diverged, or the world is closed.
            RecordingError: A recording has failed.
            KeyboardInterrupt: Ctrl-C was pressed before the time limit.
        """
        duration = None if seconds is None else duration_ns(seconds)
        with self._run(), self._driver.interruptible() as interruption:
            self._driver.run(duration, speed, shared=True)
        if seconds is not None:
            interruption.raise_pressed()

    def stop(self) -> None:
        """Ends the current `run` or `spin` after the current step. Callable on any thread."""
        if self.lock.runner is not None:
            self.session.simulation.stop()

    @property
    def _is_paced(self) -> bool:
        """Whether runs follow the wall clock or have clients, which need the thread."""
        return self._connections is not None or self.pace is not None

    def _run(self) -> Turn:
        """Runs the block, which may close the world."""
        return Turn(self)

    def _begin(self) -> int | None:
        """Begins a run, and returns the thread of another one that is in progress."""
        simulation = self.session.simulation
        if simulation.closed:
            self._check_open()
        outer = self.lock.runner
        thread = threading.get_ident()
        if outer == thread:
            raise SimulationError(
                "a callback runs the world that called it",
                code=RUN_NESTED,
                hint="Call run and spin outside of callbacks.",
            )
        if self._connections is not None:
            self._connections.raise_failure()
            if outer is None:
                self._connections.update()
        elif outer is None:
            self.session.update_robots()
        self.lock.runner = thread
        if outer is None:
            if thread != threading.main_thread().ident and threading.current_thread().daemon:
                # Otherwise it would run while libraries end what it uses, such as OpenGL.
                at_exit.close_at_exit(self, self._end_with_process)
                self._ends_at_exit = True
                at_exit.end_thread_if_exiting()
            if simulation.run_state is not RunState.RUNNING:
                self._driver.begin()
        return outer

    def _finish(self, outer: int | None, *, failed: bool) -> None:
        """Ends the run that `_begin` began."""
        try:
            if not failed and self._connections is not None:
                self._connections.raise_failure()
        finally:
            self.lock.runner = outer
            if outer is None:
                if self._ends_at_exit:
                    self._ends_at_exit = False
                    at_exit.forget(self)
                self._driver.end()
                if self._closing:
                    self._end()
                if self._connections is not None:
                    self._connections.update()
                    self._driver.pacer.show()

    def _end_with_process(self) -> None:
        """Ends a run of a daemon thread at the end of the process, which does not wait for it."""
        self.session.simulation.stop()
        # The thread, which may begin the next run, then waits forever.
        if self.lock.acquire_within(at_exit.PATIENCE) and not at_exit.only_daemons_are_left():
            self.lock.release()

    # -- connections

    def connect_ros1(self, node: str = "gazebo", arguments: Sequence[str] = ()) -> Ros1Connection:
        """Adds a ROS 1 node with Gazebo's topics and services, as ``cartwheel run --ros1``.

        Args:
            node: Name of the node.
            arguments: ROS arguments such as ``__ns:=/lab``.

        Returns:
            The connection, with the attributes `name` and `master_uri`. `close` ends it.

        Raises:
            CartwheelError: A name is invalid, or no ROS master can be used.
        """
        with self._used():
            return self._connected(ros1=True).assembly.connect_ros1(node, arguments)

    def connect_ros2(
        self, node: str = "gazebo", *, rmw: Literal["dds", "zenoh"] = "dds"
    ) -> Ros2Connection:
        """Adds a ROS 2 node with Gazebo's topics and services, as ``cartwheel run --ros2``.

        Args:
            node: Name of the node.
            rmw: The middleware.

        Returns:
            The connection, with the attributes `name` and `middleware`. `close` ends it.

        Raises:
            CartwheelError: A name is invalid, or a dependency is missing.
        """
        with self._used():
            return self._connected().assembly.connect_ros2(node, rmw)

    def serve_foxglove(self, port: int = 8765) -> str:
        """Starts a server for Foxglove, as ``cartwheel run --foxglove``.

        Args:
            port: Port to listen on; 0 selects a free port.

        Returns:
            The URL for Foxglove.

        Raises:
            CartwheelError: The optional dependency is missing, or the port is in use.
        """
        with self._used():
            return self._connected().assembly.serve_foxglove(port).url

    def serve_commands(self) -> None:
        """Lets commands such as ``cartwheel topic list`` connect. Other connections include it.

        Raises:
            ControlError: The control socket cannot be created.
        """
        with self._used():
            self._connected()

    def show(self, port: int | None = None) -> str:
        """Starts the web interface, unless it was started before.

        Args:
            port: Port to listen on; None selects the first free port from 8080.

        Returns:
            The URL for browsers.

        Raises:
            ControlError: The port is not available, or the web interface cannot start.
        """
        with self._used():
            return self._connected().show(port)

    def wait_for_browser(self, timeout: float = 60.0) -> bool:
        """Waits until a browser shows the web interface, which `show` starts.

        Args:
            timeout: Maximum wall time, s.

        Returns:
            Whether a browser shows it.
        """
        end = time.monotonic() + scalar(timeout, "timeout", least=0.0)
        while self._browsers() == 0:
            if time.monotonic() >= end:
                return False
            time.sleep(_LOOK)
        return True

    def _browsers(self) -> int:
        with self._used():
            return 0 if self._connections is None else self._connections.browsers

    def _connected(self, *, ros1: bool = False) -> Connections:
        if self._connections is None:
            from cartwheel.assembly.connections import Connections

            made = Connections(host=self._host, allow_origin=self._allow_origin)
            try:
                self._attach(made, ros1=ros1)
            except BaseException:
                made.close()
                raise
        assert self._connections is not None
        return self._connections

    def _attach(self, connections: Connections, *, ros1: bool) -> None:
        connections.attach(self.session, self._driver, self.lock, ros1=ros1)
        self._connections = connections
        connections.close_with(self)
        if self.lock.runner is None:
            self._driver.end()

    # -- end

    def close(self) -> None:
        """Ends all connections, completes recordings and closes all topics.

        Recorded values stay readable. When called within `run` or `spin`, it stops the run first.
        The memory is freed with the last reference to the world. In a process that was forked
        while the world was connected, the method does nothing.

        Raises:
            RecordingError: A recording has failed.
        """
        connections = self._connections
        if connections is not None and connections.forked:
            return
        with self.lock:
            if self.lock.runner is None:
                self._end()
                return
            self._closing = True
            self.session.simulation.stop()
            if self.lock.runner == threading.get_ident():
                return
        # Another thread spins, and closes the world when it ends.
        with self.lock:
            pass

    def _end(self) -> None:
        try:
            if self._connections is not None:
                self._connections.close()
        finally:
            self.session.close()
