"""Toggles of the scene."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

from cartwheel.simulation.snapshot import Snapshot
from cartwheel.viewer.panels.base import Panel
from cartwheel.viewer.stage import Stage

LABELS = {
    "visual": "Visual shapes",
    "collision": "Collision shapes",
    "transparent": "Transparent",
    "wireframe": "Wireframe",
    "axes": "Link frames",
    "names": "Link names",
    "inertia": "Centre of mass, inertia",
    "contacts": "Contacts and forces",
    "camera": "Camera frustum",
    "scans": "Laser scans",
    "clouds": "Point clouds",
    "trail": "Trail",
    "grid": "Grid",
    "follow": "Follow the robot",
}


class ViewPanel(Panel):
    """A checkbox for each field of `Display`."""

    def __init__(self, stage: Stage) -> None:
        super().__init__(stage)
        display = stage.scene.display
        assert set(LABELS) == {field.name for field in dataclasses.fields(display)}
        self._boxes = {}
        for name, label in LABELS.items():
            box = self.gui.add_checkbox(label, initial_value=getattr(display, name))
            box.on_update(self.page.on(self._setter(name)))
            self._boxes[name] = box
        self.gui.add_command("Follow the robot").on_trigger(self.page.do(self._toggle, "follow"))

    def show_models(self, snapshot: Snapshot) -> None:
        self.stage.overlays.forget({model.name for model in snapshot.scene.models})
        self.stage.overlays.show()

    def _toggle(self, name: str) -> None:
        self._boxes[name].value = not self._boxes[name].value
        self._apply(name)

    def _setter(self, name: str) -> Callable[[Any], None]:
        def set_from(event: Any) -> None:
            if event.client is not None:
                self._apply(name)

        return set_from

    def _apply(self, name: str) -> None:
        setattr(self.stage.scene.display, name, bool(self._boxes[name].value))
        self.stage.scene.show()
        self.stage.overlays.show()
