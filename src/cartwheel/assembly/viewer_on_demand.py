"""The web viewer of a run that was started without one."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING

from cartwheel.assembly.observer import Observer
from cartwheel.assembly.ports import free_port
from cartwheel.control.operations import PageOffer
from cartwheel.control.protocol import PATIENCE
from cartwheel.control.server import ControlServer
from cartwheel.gate.access import Access
from cartwheel.session import Session
from cartwheel.simulation.pacing import Pacer

if TYPE_CHECKING:
    from cartwheel.viewer import Viewer


class ViewerOnDemand:
    """A session's web viewer, started when a client requests it.

    Args:
        session: The session to show.
        server: Receives the requests, and announces the URL.
        pacer: Runs the session.
        observer: Is notified.
        access: Who may connect.
        port: The first port to try; ports in use are skipped.
    """

    def __init__(
        self,
        session: Session,
        server: ControlServer,
        pacer: Pacer,
        observer: Observer,
        *,
        access: Access,
        port: int,
    ) -> None:
        self._session = session
        self._server = server
        self._pacer = pacer
        self._observer = observer
        self._access, self._port = access, port
        self._lock = threading.Lock()
        self._viewer: Viewer | None = None
        self._url: str | None = None
        server.offer_page(PageOffer(show=self.show, browsers=self._browsers))

    def show(self) -> str:
        """The URL; the viewer is ready when this returns. Call it on any thread except the
        simulation's.

        Raises:
            ControlError: No port is available.
        """
        with self._lock:
            if self._url is None:
                # The import takes 0.3 s, which simulations without viewers save.
                from cartwheel.viewer import Viewer

                port = free_port(self._access.host, self._port)
                viewer = self._viewer = Viewer(
                    self._session,
                    access=self._access,
                    port=port,
                    refused=self._observer.page_refused,
                )
                starting = self._session.simulation.call(lambda: viewer.start(self._pacer))
                starting.result(PATIENCE)
                self._url = viewer.url
                self._server.announce(url=self._url, port=port)
            return self._url

    def _browsers(self) -> int:
        return 0 if self._viewer is None else self._viewer.browsers
