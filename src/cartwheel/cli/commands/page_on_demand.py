"""The viewer of a run that began without one."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING

from cartwheel.cli.commands.ports import free_port
from cartwheel.cli.commands.report import Report
from cartwheel.control.operations import PageOffer
from cartwheel.control.protocol import PATIENCE
from cartwheel.control.server import ControlServer
from cartwheel.gate.access import Access
from cartwheel.session import Session
from cartwheel.simulation.pacing import Pacer

if TYPE_CHECKING:
    from cartwheel.viewer import Viewer


class PageOnDemand:
    """The page of a session that runs without one, brought up when a client asks for it.

    Args:
        session: To show.
        server: Whose clients ask, and which then tells where the page is.
        pacer: Runs the session.
        report: Tells the user.
        access: Who may see it.
        port: The first to try; one that is taken is left to whoever has it.
    """

    def __init__(
        self,
        session: Session,
        server: ControlServer,
        pacer: Pacer,
        report: Report,
        *,
        access: Access,
        port: int,
    ) -> None:
        self._session = session
        self._server = server
        self._pacer = pacer
        self._report = report
        self._access, self._port = access, port
        self._lock = threading.Lock()
        self._viewer: Viewer | None = None
        self._url: str | None = None
        server.offer_page(PageOffer(show=self.show, browsers=self._browsers))

    def show(self) -> str:
        """Where the page is; it is up when this returns. From any thread but the simulation's.

        Raises:
            ControlError: No port can be had.
        """
        with self._lock:
            if self._url is None:
                # A third of a second that a run which nobody looks at does not spend.
                from cartwheel.viewer import Viewer

                port = free_port(self._access.host, self._port)
                viewer = self._viewer = Viewer(
                    self._session, access=self._access, port=port, refused=self._report.refused
                )
                starting = self._session.simulation.call(lambda: viewer.start(self._pacer))
                starting.result(PATIENCE)
                self._url = viewer.url
                self._server.announce(url=self._url, port=port)
            return self._url

    def _browsers(self) -> int:
        return 0 if self._viewer is None else self._viewer.browsers
