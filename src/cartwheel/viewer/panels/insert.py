"""Things to put into the world: the shipped models, and a file of one's own."""

from __future__ import annotations

import math
import tempfile
from pathlib import Path
from typing import Any

from cartwheel.description.model import RobotDescription
from cartwheel.description.packages import share
from cartwheel.errors import CartwheelError, DescriptionError
from cartwheel.geometry import Pose, quat_from_rpy, rotate
from cartwheel.simulation.naming import free_name
from cartwheel.viewer.model_view import footprint
from cartwheel.viewer.panels.base import Panel
from cartwheel.viewer.stage import Stage

_GAP = 0.15
"""m of air between what is inserted and what is there."""
_SCENERY = ("sun", "ground_plane")
_LARGEST = 20_000_000


class InsertPanel(Panel):
    """Loads a description and spawns it in front of the robot, where nothing stands."""

    def __init__(self, stage: Stage) -> None:
        super().__init__(stage)
        page, gui = self.page, self.gui
        gui.add_html('<div class="cw cw-dim cw-rows">In front of the robot</div>')
        for name, path in palette(share() / "models").items():
            label = name.replace("_", " ")
            button = gui.add_button(label, color="gray", icon=page.viser.Icon.PLUS)
            button.on_click(page.do(self.insert, path))
            command = gui.add_command(f"Insert: {label}")
            command.on_trigger(page.do(self.insert, path))
        gui.add_html('<div class="cw cw-dim">URDF, xacro or SDF of your own</div>')
        upload = gui.add_upload_button("Open a file", icon=page.viser.Icon.UPLOAD)
        upload.on_upload(page.on(lambda event: self._upload(event.target.value)))

    def insert(self, path: Path, *, name: str | None = None) -> None:
        """Spawns what a file describes.

        Raises:
            CartwheelError: It cannot be loaded; the simulation goes on undisturbed.
        """
        # Here, as reading a xacro takes a while that the simulation has not.
        from cartwheel.description import load_robot

        description: RobotDescription = load_robot(path)
        simulation, session = self.simulation, self.session
        pose = self._place(description)

        def spawn() -> str:
            wanted = free_name(name or description.name, simulation.models)
            return session.spawn(description, name=wanted, pose=pose)

        self.page.then(simulation.call(spawn), self._inserted)

    def _inserted(self, name: str) -> None:
        self.page.notify("Inserted", f"{name} stands in the world.", color="green", seconds=3.0)

    def _upload(self, file: Any) -> None:
        name = Path(file.name.replace("\\", "/")).name
        if not file.content:
            raise DescriptionError(f'"{name}" is empty')
        if len(file.content) > _LARGEST:
            raise DescriptionError(f'"{name}" is larger than {_LARGEST // 1_000_000} MB')
        with tempfile.TemporaryDirectory(prefix="cartwheel-") as folder:
            path = Path(folder) / (name or "upload.urdf")
            path.write_bytes(file.content)
            try:
                self.insert(path)
            except CartwheelError as error:
                # The folder is nothing to the user, who knows the file by its name.
                raise DescriptionError(str(error).replace(f"{folder}/", "")) from error

    def _place(self, description: RobotDescription) -> Pose:
        reach, below = footprint(description)
        taken = []
        for name, view in self.stage.scene.models.items():
            pose = self.stage.scene.pose(name)
            other, _ = footprint(view.description)
            if pose is not None and other < 20.0:
                taken.append((pose.x, pose.y, other))
        robot = self.stage.robot
        start = self.stage.scene.pose(robot) if robot is not None else None
        return free_place(start or Pose(), taken, reach=reach, below=below)


def palette(folder: Path) -> dict[str, Path]:
    """The models to choose from, by name: what stands in a folder as a file or a Gazebo model."""
    found = {path.stem: path for pattern in ("*.urdf", "*.sdf") for path in folder.glob(pattern)}
    found |= {path.parent.name: path for path in folder.glob("*/model.sdf")}
    return {name: found[name] for name in sorted(found) if name not in _SCENERY}


def free_place(
    start: Pose,
    taken: list[tuple[float, float, float]],
    *,
    reach: float,
    below: float,
) -> Pose:
    """Straight ahead of a robot, on the ground, else as little aside and beyond as is free.

    Args:
        start: The robot's.
        taken: Circles that are occupied: x, y, radius, m.
        reach: Radius of what is to be placed, m.
        below: How far it reaches below its origin, m.
    """
    height = below + 0.001
    for distance in (step * 0.25 for step in range(4, 81)):
        for aside in (0.0, 0.3, -0.3, 0.6, -0.6, 0.9, -0.9):
            heading = start.yaw + aside
            x = start.x + distance * math.cos(heading)
            y = start.y + distance * math.sin(heading)
            if all(math.hypot(x - a, y - b) > reach + r + _GAP for a, b, r in taken):
                return Pose((x, y, height), quat_from_rpy(0.0, 0.0, start.yaw))
    ahead = rotate(quat_from_rpy(0.0, 0.0, start.yaw), (21.0, 0.0, 0.0))
    return Pose((start.x + ahead[0], start.y + ahead[1], height))
