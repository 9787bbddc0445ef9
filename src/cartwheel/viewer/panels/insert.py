"""Things to put into the world: the shipped models, and a file of one's own."""

from __future__ import annotations

import math
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from cartwheel.codes.recording import UPLOAD_REFUSED
from cartwheel.description.model import RobotDescription
from cartwheel.description.packages import share
from cartwheel.description.reach import Reach
from cartwheel.errors import CartwheelError, DescriptionError, Origin
from cartwheel.geometry import Pose, quat_from_rpy
from cartwheel.simulation.naming import free_name
from cartwheel.simulation.space import Space
from cartwheel.viewer.model_view import bounds, footprint
from cartwheel.viewer.panels.base import Panel
from cartwheel.viewer.seat import Seat
from cartwheel.viewer.stage import Stage
from cartwheel.viewer.uploads import MOST_BYTES

_GAP = 0.15
"""m of air between what is inserted and what is there."""
_LIFT = 0.001
"""m above the ground at which it appears."""
_FLAT = 0.02
"""m above the ground up to which a shape is part of it."""
_SCENERY = ("sun", "ground_plane")


class InsertPanel(Panel):
    """Loads a description and spawns it in front of the robot, where nothing stands."""

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
        """Spawns what a file describes.

        Raises:
            CartwheelError: It cannot be loaded; the simulation goes on undisturbed.
        """
        # Here, as reading a xacro takes a while that the simulation has not.
        from cartwheel.description import load_robot

        description: RobotDescription = load_robot(path, reach=reach)
        simulation, session, robot = self.simulation, self.session, self.stage.robot
        size = Size.of(description)

        def spawn() -> str:
            # Only here is known what stands where: inserts may follow faster than pictures.
            start = simulation.pose(robot) if robot in simulation.models else Pose()
            pose = free_place(start, simulation.occupied(), size)
            wanted = free_name(name or description.name, simulation.models)
            return session.spawn(description, name=wanted, pose=pose)

        self.page.then(simulation.call(spawn), self._inserted)

    def _inserted(self, name: str) -> None:
        self.page.notify("Inserted", f"{name} was added to the world.", color="green", seconds=3.0)


class UploadPanel(Panel):
    """A browser's button for a file of its user's own.

    Args:
        stage: What the panels share.
        seat: The browser.
        inserting: Puts into the world what a file describes.
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
        upload.on_upload(page.on(lambda event: self._upload(event.target.value)))

    def _upload(self, file: Any) -> None:
        name = Path(file.name.replace("\\", "/")).name
        if not file.content:
            raise DescriptionError(f'"{name}" is empty', code=UPLOAD_REFUSED, values={"file": name})
        with tempfile.TemporaryDirectory(prefix="cartwheel-") as folder:
            path = Path(folder) / (name or "upload.urdf")
            path.write_bytes(file.content)
            try:
                # A browser's file may read what came with it, and no more of this machine.
                self._inserting.insert(
                    path, reach=Reach(folders=(Path(folder),), environment=False)
                )
            except CartwheelError as error:
                # The folder is nothing to the user, who knows the file by its name.
                raise _without_folder(error, folder) from error


def palette(folder: Path) -> dict[str, Path]:
    """The models to choose from, by name: what stands in a folder as a file or a Gazebo model."""
    found = {path.stem: path for pattern in ("*.urdf", "*.sdf") for path in folder.glob(pattern)}
    found |= {path.parent.name: path for path in folder.glob("*/model.sdf")}
    return {name: found[name] for name in sorted(found) if name not in _SCENERY}


@dataclass(frozen=True, kw_only=True, slots=True)
class Size:
    """How far a model reaches from its frame's origin, m."""

    reach: float
    """In the plane, in any direction."""
    below: float
    above: float

    @classmethod
    def of(cls, description: RobotDescription) -> Size:
        """That of a description."""
        reach, below = footprint(description)
        found = bounds(description)
        return cls(reach=reach, below=below, above=0.0 if found is None else float(found[1][2]))


def free_place(start: Pose, space: Space, size: Size) -> Pose:
    """Straight ahead of a robot, on the ground, else as little aside and beyond as is free.

    Args:
        start: The robot's.
        space: What is occupied.
        size: Of what is to be placed.
    """
    height = size.below + _LIFT
    here = np.array(start.position[:2])
    low, high = space.low[:, :2], space.high[:, :2]
    around = np.all((low <= here) & (here <= high), axis=1)
    overhead = space.low[:, 2] > height + size.above + _GAP
    # A floor, a house and a roof take no place. What can fall does, from any height.
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
    # Further ahead than anything reaches.
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
