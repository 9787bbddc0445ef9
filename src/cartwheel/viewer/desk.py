"""All panels around the scene, and when each of them works."""

from __future__ import annotations

from cartwheel.session import Session
from cartwheel.simulation.snapshot import Snapshot
from cartwheel.viewer.page import Page
from cartwheel.viewer.scene_view import SceneView


class Desk:
    def __init__(self, page: Page, session: Session) -> None:
        self.scene = SceneView(page)

    def update(self, snapshot: Snapshot) -> None:
        self.scene.update(snapshot)

    def close(self) -> None:
        pass
