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
        server.offer_page(PageOffer(show=self.show, browsers=lambda: self.browsers))

    def show(self, port: int | None = None, *, on_owner: bool = False) -> str:
        """The URL. The viewer is ready when this method returns.

        Args:
            port: Port to listen on; None for the first free port. An open viewer keeps its port.
            on_owner: Whether this thread runs the simulation.

        Raises:
            ControlError: The port is not available, or the viewer could not start.
        """
        with self._lock:
            if self._url is None:
                # The import takes 0.3 s, which simulations without viewers save.
                from cartwheel.viewer import Viewer

                if port is None:
                    port = free_port(self._access.host, self._port)
                viewer = self._viewer = Viewer(
                    self._session,
                    access=self._access,
                    port=port,
                    refused=self._observer.page_refused,
                )
                if on_owner:
                    self._start(viewer)
                else:
                    starting = self._session.simulation.read(lambda: self._start(viewer))
                    starting.result(PATIENCE)
                self._url = viewer.url
                self._server.announce(url=self._url, port=viewer.port)
            return self._url

    def close(self) -> None:
        """Stops the viewer, if it was started."""
        with self._lock:
            if self._viewer is not None:
                self._viewer.close()

    @property
    def browsers(self) -> int:
        """The number of connected browsers."""
        return 0 if self._viewer is None else self._viewer.browsers

    def _start(self, viewer: Viewer) -> None:
        viewer.start(self._pacer)
        self._pacer.show()
