"""Toggles for the scene."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterable
from functools import partial
from typing import Any

from cartwheel.viewer.display import Display
from cartwheel.viewer.page import Page
from cartwheel.viewer.panels.base import Panel
from cartwheel.viewer.seat import Seat
from cartwheel.viewer.stage import Stage

LABELS = {
    "visual": "Visual shapes",
    "collision": "Collision shapes",
    "transparent": "Transparent",
    "wireframe": "Wireframe",
    "axes": "Link frames",
    "names": "Link names",
    "inertia": "Mass and inertia",
    "contacts": "Contact forces",
    "camera": "Camera frustum",
    "scans": "Laser scans",
    "clouds": "Point clouds",
    "trail": "Trail",
    "grid": "Grid",
    "follow": "Follow the robot",
}
"""Label of each field in `Display`."""


def add_toggles(
    page: Page, seat: Seat, names: Iterable[str], changed: Callable[[], None]
) -> dict[str, Any]:
    """A checkbox for each of these fields in a browser's `Display`.

    Args:
        page: The page with the checkboxes.
        seat: The browser.
        names: Field names.
        changed: Called after a change.
    """

    def take(name: str, _: Any, value: bool) -> None:
        setattr(seat.display, name, bool(value))
        page.keep_toggles(seat.client, seat.display.changes())
        changed()

    boxes = {}
    for name in names:
        boxes[name] = seat.gui.add_checkbox(LABELS[name], initial_value=getattr(seat.display, name))
        boxes[name].on_update(page.on_value(partial(take, name)))
    return boxes


class ViewPanel(Panel):
    """A browser's checkboxes, one for each field in `Display`.

    Args:
        stage: Shared state of the panels.
        seat: The browser.
        look: Redraws its scene.
    """

    def __init__(self, stage: Stage, seat: Seat, look: Callable[[], None]) -> None:
        super().__init__(stage, seat)
        assert set(LABELS) == {field.name for field in dataclasses.fields(Display)}
        self._boxes = add_toggles(self.page, seat, LABELS, look)
        follow = self.gui.add_command("Follow the robot")
        follow.on_trigger(self.page.do(self._toggle, "follow"))

    def _toggle(self, name: str) -> None:
        # This calls the callback as for a user's click.
        self._boxes[name].value = not self._boxes[name].value
