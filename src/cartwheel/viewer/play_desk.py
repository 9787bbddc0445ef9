"""The panels of a recording: those of a session that only show, and a time line."""

from __future__ import annotations

from cartwheel.viewer.desk import Desk
from cartwheel.viewer.panels.base import Panel
from cartwheel.viewer.panels.camera import CameraPanel
from cartwheel.viewer.panels.imu import ImuPanel
from cartwheel.viewer.panels.notes import NotesPanel
from cartwheel.viewer.panels.timeline import TimelinePanel
from cartwheel.viewer.panels.topics import TopicsPanel
from cartwheel.viewer.panels.view import ViewPanel
from cartwheel.viewer.scans import Scans


class PlayDesk(Desk):
    """The page of a recording."""

    def build(self) -> list[Panel]:
        gui, icons = self.page.gui, self.page.viser.Icon
        gui.main_panel.dock_right()
        gui.main_panel.set_width(320)
        panels: list[Panel] = [TimelinePanel(self)]

        camera = gui.add_panel()
        with camera.add_tab("Camera", icons.CAMERA):
            panels.append(CameraPanel(self))
        camera.dock_below(gui.main_panel)

        left = gui.add_panel()
        with left.add_tab("View", icons.EYE):
            panels.append(ViewPanel(self))
        left.dock_left()
        left.set_width(300)

        lower = gui.add_panel()
        with lower.add_tab("IMU", icons.CHART_LINE):
            panels.append(ImuPanel(self))
        with lower.add_tab("Topics", icons.LIST):
            panels.append(TopicsPanel(self))
        with lower.add_tab("Warnings", icons.ALERT_TRIANGLE):
            panels.append(NotesPanel(self))
        lower.dock_below(left)
        panels.append(Scans(self))
        return panels
