"""Shows a description in the browser with joint sliders, frames, shapes and masses; no physics."""

from __future__ import annotations

import threading
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from cartwheel.description.kinematics import link_poses
from cartwheel.description.model import RobotDescription
from cartwheel.gate.access import Access
from cartwheel.gate.listening import listen
from cartwheel.geometry import Pose, to_wxyz
from cartwheel.options import PORT
from cartwheel.viewer.look import Look
from cartwheel.viewer.model_view import ModelView, footprint
from cartwheel.viewer.page import Page
from cartwheel.viewer.panels.base import escape, facts, rows_html
from cartwheel.viewer.panels.joints import add_slider
from cartwheel.viewer.panels.notes import notes_html
from cartwheel.viewer.panels.view import add_toggles
from cartwheel.viewer.scene_view import GRID, add_grid, set_stage
from cartwheel.viewer.seat import Seat

_TOGGLES = (
    "visual",
    "collision",
    "transparent",
    "wireframe",
    "axes",
    "names",
    "inertia",
    "grid",
)
"""Fields in `Display`."""


class DescriptionViewer:
    """Shows a description at `url`.

    Args:
        description: Description of a robot or model.
        access: Who may connect; None for users of this computer.
        port: 0 selects a free port.
        refused: Called with the origin of each rejected web page, on any thread.

    Raises:
        ControlError: The port is not available.
    """

    def __init__(
        self,
        description: RobotDescription,
        *,
        access: Access | None = None,
        port: int = 8080,
        refused: Callable[[str], None] = lambda _: None,
    ) -> None:
        self._description = description
        self._stopped = threading.Event()
        access = access or Access(host="127.0.0.1")
        listener = listen(access.host, port, title="the web interface", option=PORT)
        title = f"Cartwheel: {description.name}"
        self._page = Page(listener, access, title=title, refused=refused)
        self._seats: dict[int, Seat] = {}
        self._sliders: dict[str, Any] = {}
        set_stage(self._page)
        add_grid(self._page)
        self._model = ModelView(
            self._page.scene, description.name, description, problem=self._page.show_error
        )
        _, below = footprint(description)
        self._lift = Pose((0.0, 0.0, below))
        self._set_camera()
        self._build()
        self._move()
        self._page.on_clients = self._clients_changed

    @property
    def url(self) -> str:
        """URL of the web interface."""
        return self._page.url

    def run(self) -> None:
        """Handles the sliders until `close`."""
        try:
            self._page.run(self._stopped)
        finally:
            self._page.close()

    def start(self) -> None:
        """Starts `run` on a separate thread."""
        self._thread = threading.Thread(target=self.run, name="viewer", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Stops the web server."""
        self._stopped.set()
        self._page.wake()

    def _set_camera(self) -> None:
        size = max(0.15, self._model.size)
        camera = self._page.server.initial_camera
        camera.position = (1.5 * size, -1.7 * size, 1.1 * size)
        camera.look_at = (0.0, 0.0, 0.3 * size)

    def _build(self) -> None:
        gui, icons = self._page.gui, self._page.viser.Icon
        gui.main_panel.dock_right()
        gui.main_panel.set_width(330)
        rows = {"name": escape(self._description.name)} | facts(self._description)
        gui.add_html(f'<div class="cw">{rows_html(rows)}</div>')
        tabs = gui.add_tab_group()
        with tabs.add_tab("Joints", icons.ADJUSTMENTS):
            self._build_joints()
        self._view = tabs.add_tab("View", icons.EYE)
        with tabs.add_tab("Warnings", icons.ALERT_TRIANGLE):
            gui.add_html(notes_html(self._description.diagnostics))

    def _build_joints(self) -> None:
        gui, page = self._page.gui, self._page
        moving = [j for j in self._description.joints if j.drivable and j.mimic is None]
        if not moving:
            gui.add_html('<div class="cw cw-dim">No movable joints.</div>')
            return
        for joint in moving:
            slider = add_slider(gui, joint, 0.0)
            slider.on_update(page.do(self._move))
            self._sliders[joint.name] = slider
        gui.add_button("Set all to zero", icon=page.viser.Icon.REFRESH).on_click(
            page.do(self._zero)
        )

    def _zero(self) -> None:
        for slider in self._sliders.values():
            slider.value = min(slider.max, max(slider.min, 0.0))
        self._move()

    def _clients_changed(self) -> None:
        """Each browser has separate toggles."""
        handles = self._page.server.get_clients()
        self._seats = {n: seat for n, seat in self._seats.items() if n in self._page.clients}
        for number in sorted(self._page.clients - set(self._seats)):
            if number in handles:
                self._seats[number] = seat = Seat(self._page, handles[number])
                show = partial(self._show, seat, Look(seat))
                with self._view:
                    add_toggles(self._page, seat, _TOGGLES, show)
                show()

    def _show(self, seat: Seat, look: Look) -> None:
        look.show({self._description.name: self._model})
        seat.hide("grid", () if seat.display.grid else (GRID,))

    def _move(self) -> None:
        positions = {name: float(slider.value) for name, slider in self._sliders.items()}
        poses = link_poses(self._description, positions)
        placed = [self._lift @ poses[link.name] for link in self._description.links]
        with self._page.server.atomic():
            self._model.move(
                np.array([pose.position for pose in placed]),
                np.array([to_wxyz(pose.orientation) for pose in placed]),
            )
