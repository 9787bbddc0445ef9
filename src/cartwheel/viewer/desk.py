"""Creates all panels around the scene and updates them."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeVar

from cartwheel.interfaces import RunningSession
from cartwheel.simulation.snapshot import Snapshot
from cartwheel.viewer.framing import robot_of
from cartwheel.viewer.look import Look
from cartwheel.viewer.overlays import Overlays
from cartwheel.viewer.page import Page
from cartwheel.viewer.panels.base import Panel
from cartwheel.viewer.panels.bumper import BumperPanel
from cartwheel.viewer.panels.camera import CameraPanel
from cartwheel.viewer.panels.clock import ClockPanel
from cartwheel.viewer.panels.drive import DrivePanel
from cartwheel.viewer.panels.imu import ImuPanel
from cartwheel.viewer.panels.insert import InsertPanel, UploadPanel
from cartwheel.viewer.panels.joints import JointsPanel
from cartwheel.viewer.panels.notes import NotesPanel
from cartwheel.viewer.panels.topics import TopicsPanel
from cartwheel.viewer.panels.view import ViewPanel
from cartwheel.viewer.panels.world import WorldPanel
from cartwheel.viewer.scans import Scans
from cartwheel.viewer.scene_view import GRID
from cartwheel.viewer.seat import Seat
from cartwheel.viewer.stage import Stage

P = TypeVar("P", bound=Panel)


@dataclass
class _Place:
    """The panels of one browser."""

    seat: Seat
    look: Callable[[], None]
    overlays: Overlays
    panels: list[Panel]


class Desk:
    """The web interface of a session: scene in the middle, controls on the right, world on the
    left.

    Panels that show the simulation are created once for all browsers. Panels for choosing,
    selecting and driving are created for each browser, in shared tabs.

    Args:
        page: The page to build on.
        session: The session to show.
    """

    def __init__(self, page: Page, session: RunningSession) -> None:
        self.page = page
        self.stage = Stage(page, session)
        self._graph = session.graph
        self._tabs: dict[str, Any] = {}
        self._panels = self.build()
        self._places: dict[int, _Place] = {}
        self._graph_changed = -1
        page.on_clients = self._clients_changed
        page.on_silence = self._stop

    def update(self, snapshot: Snapshot) -> None:
        """Shows a state."""
        now = time.monotonic()
        stage = self.stage
        panels = self._all_panels()
        if self._graph.changed != self._graph_changed:
            self._graph_changed = self._graph.changed
            topics = self._graph.topics()
            for panel in panels:
                panel.show_topics(topics)
        if stage.scene.update(snapshot):
            stage.robot = robot_of(snapshot.scene)
            stage.frustums.show()
            for panel in panels:
                panel.show_models(snapshot)
            for place in self._places.values():
                place.look()
        for panel in panels:
            panel.update(snapshot, now)
        pose = stage.scene.pose(stage.robot) if stage.robot is not None else None
        stage.trail.update(snapshot, pose)
        for place in self._places.values():
            place.overlays.update(pose, now)

    def close(self) -> None:
        """Closes all subscriptions."""
        for panel in self._all_panels():
            panel.leave()

    def panel(self, kind: type[P], number: int | None = None) -> P:
        """The panel of a kind, shared or for one browser; by default the first browser's."""
        places = self._places.values() if number is None else [self._places[number]]
        own = [panel for place in places for panel in place.panels]
        return next(panel for panel in (*self._panels, *own) if isinstance(panel, kind))

    def _all_panels(self) -> list[Panel]:
        return [*self._panels, *(p for place in self._places.values() for p in place.panels)]

    def _clients_changed(self) -> None:
        clients = self.page.clients
        before = bool(self._places)
        for number in set(self._places) - clients:
            place = self._places.pop(number)
            del self.stage.seats[number]
            for panel in place.panels:
                panel.leave()
        handles = self.page.server.get_clients()
        for number in sorted(clients - set(self._places)):
            if number in handles:
                place = self._welcome(Seat(self.page, handles[number]))
                self._places[number] = place
                self.stage.seats[number] = place.seat
        if before != bool(self._places):
            for panel in self._panels:
                (panel.watch if self._places else panel.leave)()

    def _welcome(self, seat: Seat) -> _Place:
        """Creates the panels of a new browser in the current state."""
        stage = self.stage
        look = Look(seat)

        def show() -> None:
            world = [panel for panel in panels if isinstance(panel, WorldPanel)]
            look.show(stage.scene.models, through=world[0].selected if world else None)
            seat.hide("camera", () if seat.display.camera else stage.frustums.nodes)
            seat.hide("grid", () if seat.display.grid else (GRID,))

        panels: list[Panel] = []
        self.build_own(seat, show, panels)
        topics = self._graph.topics()
        snapshot = stage.scene.snapshot
        for panel in panels:
            panel.show_topics(topics)
            if snapshot is not None:
                panel.show_models(snapshot)
            panel.watch()
        show()
        return _Place(seat, show, Overlays(seat, stage.trail), panels)

    def _stop(self, number: int) -> None:
        """Stops driving for a browser that no longer responds."""
        place = self._places.get(number)
        for panel in place.panels if place is not None else ():
            if isinstance(panel, DrivePanel):  # recordings have no drive panel
                panel.leave()

    def build(self) -> list[Panel]:
        """Creates the shared panels."""
        gui, icons = self.page.gui, self.page.viser.Icon
        gui.main_panel.dock_right()
        gui.main_panel.set_width(320)
        panels = self.build_main()

        camera = gui.add_panel()
        self._tabs["camera"] = camera.add_tab("Camera", icons.CAMERA)
        camera.dock_below(gui.main_panel)

        left = gui.add_panel()
        panels += self.build_left(left)
        self._tabs["view"] = left.add_tab("View", icons.EYE)
        left.dock_left()
        left.set_width(300)

        lower = gui.add_panel()
        with lower.add_tab("IMU", icons.CHART_LINE):
            panels.append(ImuPanel(self.stage))
        self._tabs["topics"] = lower.add_tab("Topics", icons.LIST)
        with lower.add_tab("Warnings", icons.ALERT_TRIANGLE):
            panels.append(NotesPanel(self.stage))
        lower.dock_below(left)
        panels.append(Scans(self.stage))
        return panels

    def build_main(self) -> list[Panel]:
        """The panels in the main column, above the camera."""
        return [ClockPanel(self.stage), BumperPanel(self.stage)]

    def build_left(self, left: Any) -> list[Panel]:
        """The panels on the left, above the scene toggles."""
        icons = self.page.viser.Icon
        self._tabs["world"] = left.add_tab("World", icons.WORLD)
        self.stage.scene.clicked = self._clicked
        self._tabs["insert"] = left.add_tab("Insert", icons.PLUS)
        with self._tabs["insert"]:
            insert = InsertPanel(self.stage)
        tab = left.add_tab("Joints", icons.ADJUSTMENTS)
        with tab:
            joints = JointsPanel(self.stage, tab)
        return [insert, joints]

    def build_own(self, seat: Seat, look: Callable[[], None], panels: list[Panel]) -> None:
        """Adds the panels of one browser: driving, selecting and choosing.

        Args:
            seat: The browser.
            look: Redraws its scene.
            panels: The list to extend.
        """
        panels.append(DrivePanel(self.stage, seat))
        with self._tabs["world"]:
            panels.append(WorldPanel(self.stage, seat, look, self._tabs["world"]))
        with self._tabs["insert"]:
            panels.append(UploadPanel(self.stage, seat, self.panel(InsertPanel)))
        self.build_looking(seat, look, panels)

    def build_looking(self, seat: Seat, look: Callable[[], None], panels: list[Panel]) -> None:
        """Adds the panels that select what a browser shows."""
        with self._tabs["camera"]:
            panels.append(CameraPanel(self.stage, seat))
        with self._tabs["view"]:
            panels.append(ViewPanel(self.stage, seat, look))
        with self._tabs["topics"]:
            panels.append(TopicsPanel(self.stage, seat))

    def _clicked(self, number: int, name: str) -> None:
        if number in self._places:
            self.panel(WorldPanel, number).select(name)
