"""The connections of a simulation that a program runs."""

from __future__ import annotations

import os
import sys
import threading
import weakref
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from cartwheel.assembly import at_exit
from cartwheel.assembly.assembly import Assembly
from cartwheel.assembly.attendant import Attendant
from cartwheel.assembly.driver import Driver
from cartwheel.assembly.names import world_title
from cartwheel.assembly.observer import Observer
from cartwheel.assembly.turns import Turns
from cartwheel.description.files.readable_files import run_folders
from cartwheel.errors import Diagnostic
from cartwheel.forks import keep_object
from cartwheel.gate.access import Access, refused_page

if TYPE_CHECKING:
    from cartwheel.assembly.plan import Plan
    from cartwheel.assembly.viewer_on_demand import ViewerOnDemand
    from cartwheel.session import Session

NODE = "gazebo"
"""Default name of the ROS nodes."""
FOXGLOVE_PORT = 8765
VIEWER_PORT = 8080
"""The first port to try."""


class Connections:
    """An `Assembly` whose clients are served between two runs, too.

    Call the methods on the thread that has its turn, except `show`. The connections are closed at
    the end of the process at the latest.

    Args:
        host: Address on which the viewer and the Foxglove server listen.
        allow_origin: Origins of further web pages that may connect to them.

    Raises:
        CartwheelError: The address or an origin is invalid.
    """

    def __init__(self, *, host: str, allow_origin: Sequence[str]) -> None:
        self._observer = _ReportingObserver()
        self.assembly = Assembly(access=Access.of(host, allow_origin), observer=self._observer)
        self._turns: Turns | None = None
        self._attendant: Attendant | None = None
        self._viewer: ViewerOnDemand | None = None
        self._pid = os.getpid()
        self._closing = threading.Lock()
        self.closed = False
        self._owner: weakref.ref[object] | None = None
        keep_object(self)
        at_exit.close_at_exit(self, self.close_at_exit)

    @property
    def forked(self) -> bool:
        """Whether this process was forked from the one that has the connections."""
        return os.getpid() != self._pid

    def prepare(self, plan: Plan) -> None:
        """Checks the options, and starts processes while the world is loaded.

        Raises:
            CartwheelError: An option is invalid.
        """
        plan.check()
        self.assembly.prepare(plan.bridges)

    def attach(self, session: Session, driver: Driver, turns: Turns, *, ros1: bool) -> None:
        """Makes the session available to the commands of Cartwheel.

        Args:
            session: The session.
            driver: Runs it.
            turns: Held while a thread uses it.
            ros1: Whether ROS 1 is connected next.

        Raises:
            ControlError: The control socket cannot be created.
        """
        simulation = session.simulation
        self._observer.session = session
        # Errors in the messages of other programs do not end the run.
        simulation.faults.tolerant = not session.strict
        session.allow_path += tuple(run_folders(_files(session)))
        self._turns = turns
        self._attendant = Attendant(simulation, turns)
        self.assembly.attach(session, driver.pacer)
        self.assembly.serve_control(_title(session), ros=ros1)
        self._viewer = self.assembly.offer_viewer(VIEWER_PORT)
        driver.connected = True

    def close_with(self, owner: object) -> None:
        """Closes the connections when the memory of an object is freed."""
        self._owner = weakref.ref(owner, lambda _: self._abandon())

    def open(self, plan: Plan) -> None:
        """Opens the requested connections.

        Raises:
            CartwheelError: A connection cannot be opened.
        """
        if plan.viewer:
            self.show(plan.viewer_port)
        plan.connect(self.assembly)
        self._serve_reads()

    def show(self, port: int | None, *, on_owner: bool = True) -> str:
        """See `ViewerOnDemand.show`."""
        assert self._viewer is not None
        return self._viewer.show(port, on_owner=on_owner)

    @property
    def browsers(self) -> int:
        """The number of browsers that show the simulation."""
        return 0 if self._viewer is None else self._viewer.browsers

    def update(self) -> None:
        """See `Assembly.update`."""
        if self.forked:
            return
        self.assembly.update()
        self._serve_reads()

    def raise_failure(self) -> None:
        """See `Assembly.raise_failure`."""
        if not self.forked:
            self.assembly.raise_failure()

    def leave_to_parent(self) -> None:
        """Ends the use of the simulation in a forked process."""
        if self.closed:
            return
        if self._turns is not None:
            self._turns.abandon()
            # The process may have been forked by a callback. Its run ends.
            self.assembly.session.simulation.stop()

    def close(self) -> None:
        """Closes all connections and completes the recordings. Other threads that call it wait.

        A forked process has no part in the connections.

        Raises:
            RecordingError: A recording has failed.
        """
        if self.forked:
            return
        with self._closing:
            if self.closed:
                return
            self.closed = True
            try:
                self.assembly.close()
            finally:
                at_exit.forget(self)
                self._owner = None
                if self._attendant is not None:
                    self._attendant.close()

    def close_at_exit(self) -> None:
        """Stops a run on another thread, and closes the connections."""
        entered = False
        if self._turns is not None:
            self.assembly.session.simulation.stop()
            entered = self._turns.acquire_within(at_exit.PATIENCE)
        try:
            self.close()
        finally:
            if entered and self._turns is not None:
                self._turns.release()

    def _abandon(self) -> None:
        # The thread that happens to free the memory may be one that the connections need.
        if not self.closed and not self.forked:
            threading.Thread(target=self.close, name="close").start()

    def _serve_reads(self) -> None:
        """Delivers latched messages before anything else happens."""
        self.assembly.session.simulation.serve_reads()


class _ReportingObserver(Observer):
    """Reports what a user must know in the diagnostics of the session."""

    session: Session | None = None

    def disconnected(self, diagnostic: Diagnostic) -> None:
        self._report(diagnostic)

    def page_refused(self, origin: str) -> None:
        self._report(refused_page("the web interface", origin))

    def _report(self, diagnostic: Diagnostic) -> None:
        if self.session is not None:
            self.session.simulation.report(diagnostic)


def _files(session: Session) -> Iterable[str]:
    """The files of the world and its models."""
    origins = [session.simulation.world.origin]
    origins += [placed.description.origin for placed in session.simulation.scene.models]
    return [origin.file for origin in origins if not origin.file.startswith("<")]


def _title(session: Session) -> str:
    """Names the world and the program in listings of simulations."""
    program = Path(sys.argv[0]).name if sys.argv else ""
    world = world_title(session.simulation.world)
    return f"{world} in {program}" if program else world


def port(wanted: bool | int, default: int | None) -> int | None:
    """The port of a server; None if it is not wanted.

    Args:
        wanted: Whether to start the server, or its port. 0 selects a free port.
        default: The port for True.
    """
    if wanted is False:
        return None
    return default if wanted is True else int(wanted)
