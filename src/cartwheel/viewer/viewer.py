"""The web viewer of a running session."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import TYPE_CHECKING

from cartwheel.codes.recording import VIEWER_NOT_STARTED
from cartwheel.errors import ControlError
from cartwheel.gate.access import Access
from cartwheel.gate.listening import listen
from cartwheel.interfaces import RunningSession, SnapshotSource
from cartwheel.options import PORT
from cartwheel.simulation.snapshot import Snapshot
from cartwheel.viewer.page import Page
from cartwheel.viewer.teleop import KEYS

if TYPE_CHECKING:
    from cartwheel.viewer.desk import Desk

RATE = 30.0
"""Rate at which the scene follows the simulation, Hz of wall time."""


class Viewer:
    """Shows a session at `url` and handles user input, as a client of its graph.

    The simulation's thread only stores its latest snapshot here. While no browser is connected, it
    stores only snapshots with changed models. Everything else runs on the viewer's own thread.

    Args:
        session: The session to show.
        access: Who may connect; None for users of this computer.
        port: 0 selects a free port.
        desk: Creates the panels; None for a simulation's panels.
        refused: Called with the origin of each rejected web page, on any thread.

    Raises:
        ControlError: The port is not available.
    """

    def __init__(
        self,
        session: RunningSession,
        *,
        access: Access | None = None,
        port: int = 8080,
        desk: Callable[[Page, RunningSession], Desk] | None = None,
        refused: Callable[[str], None] = lambda _: None,
    ) -> None:
        self._access = access or Access(host="127.0.0.1")
        self._listener = listen(self._access.host, port, title="the web interface", option=PORT)
        self._session = session
        self._make_desk = desk
        self._refused = refused
        self._slot: Snapshot | None = None
        self._latest: Snapshot | None = None
        self._version = -1
        self._page: Page | None = None
        self._desk: Desk
        self._ready = threading.Event()
        self._stopped = threading.Event()
        self._failure: BaseException | None = None
        self._thread = threading.Thread(target=self._run, name="viewer", daemon=True)

    @property
    def port(self) -> int:
        """The port that it listens on."""
        return int(self._listener.getsockname()[1])

    @property
    def url(self) -> str:
        """URL of the web interface. Waits for the server, which determines the port at startup.

        Raises:
            ControlError: The server did not start.
        """
        if not self._thread.is_alive() and not self._ready.is_set():
            raise ControlError("the web interface has not been started", code=VIEWER_NOT_STARTED)
        self._ready.wait()
        if self._failure is not None:
            raise ControlError(
                f"the web interface did not start: {self._failure}", code=VIEWER_NOT_STARTED
            ) from self._failure
        assert self._page is not None
        return self._page.url

    @property
    def browsers(self) -> int:
        """Number of connected browsers."""
        return 0 if self._page is None else len(self._page.clients)

    def start(self, pacer: SnapshotSource) -> None:
        """Starts the server and shows the simulation of `pacer`."""
        pacer.add_listener(self._listen, rate=RATE)
        self._thread.start()

    def close(self) -> None:
        """Stops the server and closes all subscriptions."""
        self._stopped.set()
        if self._page is not None:
            self._page.wake()
        if self._thread.is_alive():
            self._thread.join(timeout=10.0)
        self._listener.close()

    def _listen(self, snapshot: Snapshot) -> None:
        """Runs on the simulation's thread: stores the latest snapshot, and queues a job if none is
        pending.
        """
        page, self._latest = self._page, snapshot
        if page is None or self._stopped.is_set():
            return
        if snapshot.scene.version != self._version:
            self._version = snapshot.scene.version
            page.post(lambda: self._desk.stage.framing.update(snapshot))
        if not page.clients:
            return
        first = self._slot is None
        self._slot = snapshot
        if first:
            page.post(self._show)

    def _run(self) -> None:
        try:
            from cartwheel.viewer.desk import Desk

            page = Page(
                self._listener, self._access, title="Cartwheel", keys=KEYS, refused=self._refused
            )
            self._desk = (self._make_desk or Desk)(page, self._session)
            self._desk_changed, page.on_clients = page.on_clients, self._clients_changed
            self._page = page
            page.post(self._show_latest)
        except BaseException as error:  # noqa: BLE001 - `url` raises it
            self._failure = error
            return
        finally:
            self._ready.set()
        try:
            page.run(self._stopped)
        finally:
            self._desk.close()
            page.close()

    def _clients_changed(self) -> None:
        self._desk_changed()
        self._show_latest()

    def _show_latest(self) -> None:
        """Shows the last state, because a simulation that waits or is paused sends no other."""
        snapshot = self._latest
        if snapshot is None:
            return
        if snapshot.scene.version != self._version:
            self._version = snapshot.scene.version
            self._desk.stage.framing.update(snapshot)
        if self._page is not None and self._page.clients:
            self._desk.update(snapshot)

    def _show(self) -> None:
        snapshot, self._slot = self._slot, None
        if snapshot is not None:
            self._desk.update(snapshot)
