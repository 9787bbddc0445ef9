"""The scene, its overlays and the selected robot, shared by the panels."""

from __future__ import annotations

from cartwheel.interfaces import RunningSession
from cartwheel.viewer.framing import Framing
from cartwheel.viewer.overlays import Frustums, Trail
from cartwheel.viewer.page import Page
from cartwheel.viewer.scene_view import SceneView
from cartwheel.viewer.seat import Seat


class Stage:
    """Shared state of the panels.

    Args:
        page: The page to build on.
        session: The session to show.
    """

    def __init__(self, page: Page, session: RunningSession) -> None:
        self.page = page
        self.session = session
        self.robot: str | None = None
        """The model that the camera follows and in front of which models are inserted."""
        self.scene = SceneView(page)
        self.framing = Framing(page, session.simulation)
        self.frustums = Frustums(page, self.scene)
        self.trail = Trail()
        self.seats: dict[int, Seat] = {}
        """The connected browsers, by number."""
        self.drivers: dict[str, int] = {}
        """The last browser that drove on each topic."""
