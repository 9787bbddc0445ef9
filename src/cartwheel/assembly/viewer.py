"""The web viewer of a run, started in parallel and announced when it is ready."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import TYPE_CHECKING

from cartwheel.assembly.observer import Observer
from cartwheel.codes.recording import VIEWER_NOT_STARTED
from cartwheel.control.operations import PageOffer
from cartwheel.control.protocol import PATIENCE
from cartwheel.control.server import ControlServer
from cartwheel.errors import CartwheelError, ControlError
from cartwheel.gate.access import Access
from cartwheel.interfaces import RunningSession, SnapshotSource
from cartwheel.viewer import Viewer

if TYPE_CHECKING:
    from cartwheel.viewer.desk import Desk
    from cartwheel.viewer.page import Page


class AnnouncedViewer:
    """The web viewer of a session.

    Args:
        session: The session to show.
        server: Announces the URL to other processes.
        observer: Is notified.
        access: Who may connect.
        port: Port to listen on.
        open_browser: Whether to open a browser.
        desk: Creates its panels; None for a simulation's panels.
    """

    def __init__(
        self,
        session: RunningSession,
        server: ControlServer,
        observer: Observer,
        *,
        access: Access,
        port: int,
        open_browser: bool = False,
        desk: Callable[[Page, RunningSession], Desk] | None = None,
    ) -> None:
        self._session = session
        self._access = access
        self._server = server
        self._open = open_browser
        self._observer = observer
        self._viewer = Viewer(
            session, access=access, port=port, desk=desk, refused=observer.page_refused
        )
        self._failure: CartwheelError | None = None
        self._started = threading.Event()
        server.offer_page(
            PageOffer(show=self._url, browsers=lambda: self._viewer.browsers),
        )

    def start(self, pacer: SnapshotSource) -> None:
        """Starts the web viewer while the simulation begins. Call it on the owner's thread."""
        self._viewer.start(pacer)
        self._started.set()
        threading.Thread(target=self._announce, name="announce", daemon=True).start()

    def raise_failure(self) -> None:
        """Raises the error that prevented the start.

        Raises:
            CartwheelError: The web viewer could not start.
        """
        if self._failure is not None:
            raise self._failure

    def _url(self) -> str:
        """The URL, once the viewer is ready."""
        if not self._started.wait(PATIENCE):
            raise ControlError(
                f"the web interface did not start within {PATIENCE:g} s", code=VIEWER_NOT_STARTED
            )
        return self._viewer.url

    def _announce(self) -> None:
        try:
            url = self._viewer.url
        except CartwheelError as error:
            self._failure = error
            self._session.simulation.stop()
            return
        self._server.announce(url=url, port=self._viewer.port)
        self._observer.viewer_shown(url, self._access)
        if self._open:
            import webbrowser

            webbrowser.open(url)
