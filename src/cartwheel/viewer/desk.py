"""All panels around the scene, and when each of them works."""

from __future__ import annotations

import time
from typing import Any

from cartwheel.session import Session
from cartwheel.simulation.snapshot import Snapshot
from cartwheel.viewer.framing import robot_of
from cartwheel.viewer.page import Page
from cartwheel.viewer.panels.base import Panel
from cartwheel.viewer.panels.bumper import BumperPanel
from cartwheel.viewer.panels.camera import CameraPanel
from cartwheel.viewer.panels.clock import ClockPanel
from cartwheel.viewer.panels.drive import DrivePanel
from cartwheel.viewer.panels.imu import ImuPanel
from cartwheel.viewer.panels.insert import InsertPanel
from cartwheel.viewer.panels.joints import JointsPanel
from cartwheel.viewer.panels.notes import NotesPanel
from cartwheel.viewer.panels.topics import TopicsPanel
from cartwheel.viewer.panels.view import ViewPanel
from cartwheel.viewer.panels.world import WorldPanel
from cartwheel.viewer.scans import Scans
from cartwheel.viewer.stage import Stage


class Desk:
    """The page of a session: scene in the middle, control to the right, world to the left.

    Args:
        page: To build it on.
        session: To show.
    """

    def __init__(self, page: Page, session: Session) -> None:
        self.page = page
        self.stage = Stage(page, session)
        self._graph = session.graph
        self._panels = self.build()
        self._graph_changed = -1
        self._watched = False
        page.on_clients = self._clients_changed

    def update(self, snapshot: Snapshot) -> None:
        """Shows a state."""
        now = time.monotonic()
        if self._graph.changed != self._graph_changed:
            self._graph_changed = self._graph.changed
            topics = self._graph.topics()
            for panel in self._panels:
                panel.show_topics(topics)
        if self.stage.scene.update(snapshot):
            self.stage.robot = robot_of(snapshot.scene)
            for panel in self._panels:
                panel.show_models(snapshot)
        for panel in self._panels:
            panel.update(snapshot, now)
        self.stage.overlays.update(snapshot, self.stage.robot, now)

    def close(self) -> None:
        """Lets go of all subscriptions."""
        for panel in self._panels:
            panel.leave()

    def _clients_changed(self) -> None:
        watched = bool(self.page.clients)
        if watched == self._watched:
            return
        self._watched = watched
        for panel in self._panels:
            (panel.watch if watched else panel.leave)()

    def build(self) -> list[Panel]:
        """Makes all panels."""
        gui, icons = self.page.gui, self.page.viser.Icon
        gui.main_panel.dock_right()
        gui.main_panel.set_width(320)
        panels = self.build_main()

        camera = gui.add_panel()
        with camera.add_tab("Camera", icons.CAMERA):
            panels.append(CameraPanel(self.stage))
        camera.dock_below(gui.main_panel)

        left = gui.add_panel()
        panels += self.build_left(left)
        with left.add_tab("View", icons.EYE):
            panels.append(ViewPanel(self.stage))
        left.dock_left()
        left.set_width(300)

        lower = gui.add_panel()
        with lower.add_tab("IMU", icons.CHART_LINE):
            panels.append(ImuPanel(self.stage))
        with lower.add_tab("Topics", icons.LIST):
            panels.append(TopicsPanel(self.stage))
        with lower.add_tab("Warnings", icons.ALERT_TRIANGLE):
            panels.append(NotesPanel(self.stage))
        lower.dock_below(left)
        panels.append(Scans(self.stage))
        return panels

    def build_main(self) -> list[Panel]:
        """The panels of the main column, above the camera."""
        return [ClockPanel(self.stage), BumperPanel(self.stage), DrivePanel(self.stage)]

    def build_left(self, left: Any) -> list[Panel]:
        """The panels to the left, above the toggles of the scene."""
        icons = self.page.viser.Icon
        tab = left.add_tab("World", icons.WORLD)
        with tab:
            world = WorldPanel(self.stage, tab)
            self.stage.scene.selected = world.select
        with left.add_tab("Insert", icons.PLUS):
            insert = InsertPanel(self.stage)
        tab = left.add_tab("Joints", icons.ADJUSTMENTS)
        with tab:
            joints = JointsPanel(self.stage, tab)
        return [world, insert, joints]
