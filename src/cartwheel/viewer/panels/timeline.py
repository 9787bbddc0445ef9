"""The timeline of a recording."""

from __future__ import annotations

from typing import Any

from cartwheel.interfaces import RunningPlayback
from cartwheel.simulation.snapshot import Snapshot
from cartwheel.viewer.every import Every
from cartwheel.viewer.panels.clock import ClockPanel
from cartwheel.viewer.stage import Stage

_PATIENCE = 0.5
"""Time after a user's change during which the slider is not updated, s."""


class TimelinePanel(ClockPanel):
    """Adds a slider to the clock; Step advances by one frame, Reset returns to the start.

    Args:
        stage: Shared state of the panels.
        player: Plays the recording.
    """

    def __init__(self, stage: Stage, player: RunningPlayback) -> None:
        super().__init__(stage)
        self._player = player
        self._start_ns = player.start_ns
        length = max((player.end_ns - player.start_ns) / 1e9, 0.001)
        self._slider = self.gui.add_slider(
            "Time, s", min=0.0, max=length, step=0.001, initial_value=0.0
        )
        self._slider.on_update(self.page.on_value(self._moved))
        self._slider_due = Every(10)
        self._left_alone = 0.0
        self._now = 0.0

    def update(self, snapshot: Snapshot, now: float) -> None:
        super().update(snapshot, now)
        self._now = now
        if now < self._left_alone or not self._slider_due(now):
            return
        shown = round((snapshot.time_ns - self._start_ns) / 1e9, 3)
        shown = min(max(shown, 0.0), float(self._slider.max))
        if abs(self._slider.value - shown) > 0.0005:
            self._slider.value = shown

    def _moved(self, event: Any, seconds: float) -> None:
        if event.client is None:
            return  # moved by `update`, not by a user
        self._left_alone = self._now + _PATIENCE
        player = self._player
        place = self._start_ns + round(seconds * 1e9)
        self.page.then(player.call(lambda: player.seek(place)))
