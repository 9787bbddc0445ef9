"""Toggles of the scene."""

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
"""Of each field of `Display`."""


def add_toggles(
    page: Page, seat: Seat, names: Iterable[str], changed: Callable[[], None]
) -> dict[str, Any]:
    """A checkbox for each of these fields of a browser's `Display`.

    Args:
        page: That they are on.
        seat: The browser.
        names: Of the fields.
        changed: Called after one was changed.
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
    """A browser's checkboxes, one for each field of `Display`.

    Args:
        stage: What the panels share.
        seat: The browser.
        look: Draws its scene anew.
    """

    def __init__(self, stage: Stage, seat: Seat, look: Callable[[], None]) -> None:
        super().__init__(stage, seat)
        assert set(LABELS) == {field.name for field in dataclasses.fields(Display)}
        self._boxes = add_toggles(self.page, seat, LABELS, look)
        follow = self.gui.add_command("Follow the robot")
        follow.on_trigger(self.page.do(self._toggle, "follow"))

    def _toggle(self, name: str) -> None:
        # Its callback is called as if the user had clicked.
        self._boxes[name].value = not self._boxes[name].value
