"""The models in the world: select, inspect, move, delete."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, TypeAlias

from cartwheel.geometry import Pose, from_wxyz, to_wxyz
from cartwheel.simulation.snapshot import PlacedModel, Snapshot
from cartwheel.viewer.every import Every
from cartwheel.viewer.panels.base import Panel, escape, facts, rows_html
from cartwheel.viewer.seat import Seat
from cartwheel.viewer.stage import Stage

_Place: TypeAlias = tuple[Sequence[float], Sequence[float]]
"""Position in m and quaternion (w, x, y, z) of a gizmo."""


class WorldPanel(Panel):
    """The list of models, and the gizmo of this browser's selected model.

    Args:
        stage: Shared state of the panels.
        seat: The browser.
        look: Redraws its scene, because clicks pass through the selected model.
        tab: The tab with the list.
    """

    def __init__(self, stage: Stage, seat: Seat, look: Callable[[], None], tab: Any) -> None:
        super().__init__(stage, seat)
        self._seat = seat
        self._look = look
        self._tab = tab
        self.selected: str | None = None
        self._rows: dict[str, Any] = {}
        self._gizmo: Any = None
        self._shown: Pose | None = None
        self._held: Pose | None = None
        """Target pose of a drag; None without a drag."""
        self._placed: _Place | None = None
        """Where this panel, and not a drag, last moved the gizmo."""
        self._due = Every(5)
        self._static_due = Every(4)
        self.gui.add_html('<div class="cw cw-dim cw-rows">Models</div>', order=0)
        self._text = self.gui.add_html("", order=900)
        self._content = ""
        self._delete = self.gui.add_button(
            "Delete",
            color="red",
            icon=self.page.viser.Icon.TRASH,
            visible=False,
            order=910,
        )
        self._delete.on_click(self.page.do(self.delete))

    def select(self, name: str | None) -> None:
        """Selects a model, or None; selecting the selected model deselects it."""
        if name == self.selected:
            name = None
        self.selected = name
        self._look()
        if self._gizmo is not None:
            self._gizmo.remove()
            self._gizmo = None
        self._held = self._shown = self._placed = None
        for row, button in self._rows.items():
            button.color = None if row == name else "gray"
        self._delete.visible = name is not None
        snapshot = self.stage.scene.snapshot
        pose = self.stage.scene.pose(name) if name is not None else None
        if name is None or pose is None or snapshot is None:
            self._say("")
            return
        self._delete.label = f"Delete {name}"
        size = self.stage.scene.models[name].size
        # Not visible before its callback is set.
        with self._seat.client.atomic():
            gizmo = self._seat.scene.add_transform_controls(
                "/gizmo",
                scale=min(1.2, max(0.25, 0.8 * size)),
                line_width=3.0,
                depth_test=False,
                position=pose.position,
                wxyz=to_wxyz(pose.orientation),
            )
            gizmo.on_update(self.page.on_value(self._drag, read=_place_of))
        self._gizmo = gizmo
        self._shown = pose
        self._describe(snapshot)

    def delete(self) -> None:
        """Deletes the selected model."""
        name, simulation = self.selected, self.simulation
        if name is None:
            return
        self.select(None)
        self.page.then(simulation.call(lambda: simulation.delete(name)))

    def leave(self) -> None:
        # A drag ends when its browser disconnects, so that no model stays in the air forever.
        self._held = None

    def show_models(self, snapshot: Snapshot) -> None:
        names = [model.name for model in snapshot.scene.models]
        for name in set(self._rows) - set(names):
            self._rows.pop(name).remove()
        with self._tab, self._seat.client.atomic():
            for i, name in enumerate(names):
                if name in self._rows:
                    continue
                row = self.gui.add_button(
                    name, color="gray", icon=self.page.viser.Icon.CUBE, order=100 + i
                )
                row.on_click(self.page.do(self.select, name))
                self._rows[name] = row
        if self.selected is not None and self.selected not in names:
            self.select(None)

    def update(self, snapshot: Snapshot, now: float) -> None:
        if self.selected is None or self._gizmo is None:
            return
        if self._held is not None:
            if not self._is_static(snapshot) or self._static_due(now):
                self._hold(self._held)
        else:
            pose = self.stage.scene.pose(self.selected)
            if pose is not None and pose != self._shown:
                self._shown = pose
                self._place_gizmo(pose.position, to_wxyz(pose.orientation))
        if self._due(now):
            self._describe(snapshot)

    def move(self, name: str, pose: Pose) -> None:
        """Moves a model to a pose and stops its motion."""
        simulation = self.simulation
        self.page.then(simulation.call(lambda: simulation.set_pose(name, pose)))

    def _drag(self, event: Any, place: _Place) -> None:
        """During a drag, holds the model at the gizmo's pose, even against gravity."""
        if event.target is not self._gizmo or self.selected is None:
            return
        if event.phase != "end":
            (x, y, z), turn = place
            self._held = self._shown = Pose((x, y, z), from_wxyz(turn))
            if _place_of(self._gizmo) == self._placed:
                # Until this thread learned of the drag, `update` moved the gizmo with the model.
                self._place_gizmo(*place)
        elif self._held is not None:
            # Not at `place`, for the same reason.
            self._hold(self._held)
            self._held = self._shown = None

    def _place_gizmo(self, position: Sequence[float], turn: Sequence[float]) -> None:
        with self._seat.client.atomic():
            self._gizmo.position = position
            self._gizmo.wxyz = turn
        self._placed = _place_of(self._gizmo)

    def _hold(self, pose: Pose) -> None:
        if self.selected is not None:
            self.move(self.selected, pose)

    def _is_static(self, snapshot: Snapshot) -> bool:
        # Moving a fixed model recompiles the world, so limit the rate to a few times per second.
        return any(m.description.static for m in snapshot.scene.models if m.name == self.selected)

    def _describe(self, snapshot: Snapshot) -> None:
        placed = next((m for m in snapshot.scene.models if m.name == self.selected), None)
        pose = self.stage.scene.pose(self.selected) if self.selected is not None else None
        if placed is None or pose is None:
            return
        self._say(properties_html(placed, pose))

    def _say(self, content: str) -> None:
        if content != self._content:
            self._text.content = self._content = content


def _place_of(gizmo: Any) -> _Place:
    return gizmo.position.tolist(), gizmo.wxyz.tolist()


def properties_html(placed: PlacedModel, pose: Pose) -> str:
    """A model's pose, mass and parts."""
    roll, pitch, yaw = (math.degrees(angle) for angle in pose.rpy)
    rows = {
        "position": f"{pose.x:z.3f}, {pose.y:z.3f}, {pose.z:z.3f} m",
        "roll, pitch, yaw": f"{roll:z.1f}, {pitch:z.1f}, {yaw:z.1f}°",
    } | facts(placed.description)
    return f'<div class="cw" data-model="{escape(placed.name)}">{rows_html(rows)}</div>'
