"""The panels of a recording: a session's read-only panels, and a timeline."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from cartwheel.interfaces import RunningPlayback, RunningSession
from cartwheel.viewer.desk import Desk
from cartwheel.viewer.page import Page
from cartwheel.viewer.panels.base import Panel
from cartwheel.viewer.panels.timeline import TimelinePanel
from cartwheel.viewer.seat import Seat


class PlayDesk(Desk):
    """The web interface of a recording.

    Args:
        page: The page to build on.
        session: The recording and its graph.
        player: Plays the recording.
    """

    def __init__(self, page: Page, session: RunningSession, *, player: RunningPlayback) -> None:
        self._player = player
        super().__init__(page, session)

    def build_main(self) -> list[Panel]:
        return [TimelinePanel(self.stage, self._player)]

    def build_left(self, left: Any) -> list[Panel]:  # noqa: ARG002 - nothing can be moved
        return []

    def build_own(self, seat: Seat, look: Callable[[], None], panels: list[Panel]) -> None:
        self.build_looking(seat, look, panels)
