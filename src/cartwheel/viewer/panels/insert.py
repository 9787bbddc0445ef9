"""Inserts built-in models or an uploaded file into the world."""

from __future__ import annotations

import math
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from cartwheel.codes.recording import UPLOAD_REFUSED
from cartwheel.description.files.package_folders import share
from cartwheel.description.files.readable_files import Reach
from cartwheel.description.model import RobotDescription
from cartwheel.errors import CartwheelError, DescriptionError, Origin
from cartwheel.geometry import Pose, quat_from_rpy
from cartwheel.simulation.models.occupied_space import Space
from cartwheel.simulation.models.unique_names import free_name
from cartwheel.viewer.model_view import bounds, footprint
from cartwheel.viewer.panels.base import Panel
from cartwheel.viewer.seat import Seat
from cartwheel.viewer.stage import Stage
from cartwheel.viewer.uploads import MOST_BYTES

_GAP = 0.15
"""Minimum gap between the inserted model and others, m."""
_LIFT = 0.001
"""Initial height above the ground, m."""
_FLAT = 0.02
"""Height above the ground up to which a shape counts as ground, m."""
_SCENERY = ("sun", "ground_plane")


class InsertPanel(Panel):
    """Loads a description and spawns it in front of the robot, in free space."""

    def __init__(self, stage: Stage) -> None:
        super().__init__(stage)
        page, gui = self.page, self.gui
        gui.add_html('<div class="cw cw-dim cw-rows">Insert in front of the robot</div>')
        for name, path in palette(share() / "models").items():
            label = name.replace("_", " ")
            button = gui.add_button(label, color="gray", icon=page.viser.Icon.PLUS)
            button.on_click(page.do(self.insert, path))
            command = gui.add_command(f"Insert: {label}")
            command.on_trigger(page.do(self.insert, path))

    def insert(self, path: Path, *, name: str | None = None, reach: Reach | None = None) -> None:
        """Spawns the description in a file.

        Raises:
            CartwheelError: The file cannot be loaded; the simulation is not affected.
        """
        # On this thread, because reading a xacro would delay the simulation.
        from cartwheel.description import load_robot

        description: RobotDescription = load_robot(path, reach=reach)
        simulation, session, robot = self.simulation, self.session, self.stage.robot
        size = Size.of(description)

        def spawn() -> str:
            # Positions are only certain here: inserts may be more frequent than snapshots.
            start = simulation.pose(robot) if robot in simulation.models else Pose()
            pose = free_place(start, simulation.occupied(), size)
            wanted = free_name(name or description.name, simulation.models)
            return session.spawn(description, name=wanted, pose=pose)

        self.page.then(simulation.call(spawn), self._inserted)

    def _inserted(self, name: str) -> None:
        self.page.notify("Inserted", f"{name} was added to the world.", color="green", seconds=3.0)


class UploadPanel(Panel):
    """A browser's button to upload a file.

    Args:
        stage: Shared state of the panels.
        seat: The browser.
        inserting: Spawns the file.
    """

    def __init__(self, stage: Stage, seat: Seat, inserting: InsertPanel) -> None:
        super().__init__(stage, seat)
        page, gui = self.page, self.gui
        self._inserting = inserting
        most = MOST_BYTES // 1_000_000
        gui.add_html(
            f'<div class="cw cw-dim">Your own URDF, xacro or SDF file, up to {most} MB</div>'
        )
        upload = gui.add_upload_button("Open a file", icon=page.viser.Icon.UPLOAD)
        upload.on_upload(page.on_value(lambda _, file: self._upload(file)))

    def _upload(self, file: Any) -> None:
        name = Path(file.name.replace("\\", "/")).name
        if not file.content:
            raise DescriptionError(f'"{name}" is empty', code=UPLOAD_REFUSED, values={"file": name})
        with tempfile.TemporaryDirectory(prefix="cartwheel-") as folder:
            path = Path(folder) / (name or "upload.urdf")
            path.write_bytes(file.content)
            try:
                # An uploaded file may refer only to files in the same upload, not to others on this
                # machine.
                self._inserting.insert(
                    path, reach=Reach(folders=(Path(folder),), environment=False)
                )
            except CartwheelError as error:
                # The temporary folder means nothing to users, who know only the file's name.
                raise _without_folder(error, folder) from error


def palette(folder: Path) -> dict[str, Path]:
    """The available models by name: files and Gazebo models in a folder."""
    found = {path.stem: path for pattern in ("*.urdf", "*.sdf") for path in folder.glob(pattern)}
    found |= {path.parent.name: path for path in folder.glob("*/model.sdf")}
    return {name: found[name] for name in sorted(found) if name not in _SCENERY}


@dataclass(frozen=True, kw_only=True, slots=True)
class Size:
    """A model's extent from its frame's origin, m."""

    reach: float
    """Maximum horizontal extent."""
    below: float
    above: float

    @classmethod
    def of(cls, description: RobotDescription) -> Size:
        """The size of a description."""
        reach, below = footprint(description)
        found = bounds(description)
        return cls(reach=reach, below=below, above=0.0 if found is None else float(found[1][2]))


def free_place(start: Pose, space: Space, size: Size) -> Pose:
    """A free pose straight ahead of a robot on the ground, otherwise the nearest to the side or
    beyond.

    Args:
        start: The robot's pose.
        space: The occupied space.
        size: Size of the model to place.
    """
    height = size.below + _LIFT
    here = np.array(start.position[:2])
    low, high = space.low[:, :2], space.high[:, :2]
    around = np.all((low <= here) & (here <= high), axis=1)
    overhead = space.low[:, 2] > height + size.above + _GAP
    # Floors, surrounding walls and roofs are ignored. Movable shapes block any height, because they
    # can fall.
    taken = ~(space.fixed & (around | overhead)) & (space.high[:, 2] > _FLAT)
    low, high = low[taken], high[taken]
    turn = quat_from_rpy(0.0, 0.0, start.yaw)
    for distance in (step * 0.25 for step in range(4, 81)):
        for aside in (0.0, 0.3, -0.3, 0.6, -0.6, 0.9, -0.9):
            heading = start.yaw + aside
            spot = here + distance * np.array((math.cos(heading), math.sin(heading)))
            gaps = np.maximum(0.0, np.maximum(low - spot, spot - high))
            if np.all(np.hypot(gaps[:, 0], gaps[:, 1]) > size.reach + _GAP):
                return Pose((float(spot[0]), float(spot[1]), height), turn)
    # Farther ahead than any occupied space.
    ahead = np.array((math.cos(start.yaw), math.sin(start.yaw)))
    furthest = np.maximum((low - here) * ahead, (high - here) * ahead).sum(axis=1).max(initial=0.0)
    spot = here + ahead * (furthest + size.reach + 2 * _GAP)
    return Pose((float(spot[0]), float(spot[1]), height), turn)


def _without_folder(error: CartwheelError, folder: str) -> DescriptionError:
    def cut(text: str) -> str:
        return text.replace(f"{folder}/", "")

    origin = error.origin
    return DescriptionError(
        cut(error.message),
        code=error.code,
        origin=origin
        and Origin(file=cut(origin.file), line=origin.line, stack=tuple(map(cut, origin.stack))),
        hint=cut(error.hint or "") or None,
        values=error.values,
    )
