"""The middle of the page: the scene, what is drawn over it, and which robot it is about."""

from __future__ import annotations

from cartwheel.session import Session
from cartwheel.viewer.framing import Framing
from cartwheel.viewer.overlays import Frustums, Trail
from cartwheel.viewer.page import Page
from cartwheel.viewer.scene_view import SceneView
from cartwheel.viewer.seat import Seat


class Stage:
    """What the panels share.

    Args:
        page: To build it on.
        session: To show.
    """

    def __init__(self, page: Page, session: Session) -> None:
        self.page = page
        self.session = session
        self.robot: str | None = None
        """The model that the camera follows and that things are inserted in front of."""
        self.scene = SceneView(page)
        self.framing = Framing(page, session.simulation)
        self.frustums = Frustums(page, self.scene)
        self.trail = Trail()
        self.seats: dict[int, Seat] = {}
        """The browsers that are connected, by number."""
        self.drivers: dict[str, int] = {}
        """The browser that was the last to drive on a topic."""
