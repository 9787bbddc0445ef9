"""The world in the browser: models, moving links, lighting."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from cartwheel.description.model import RobotDescription
from cartwheel.errors import CartwheelError
from cartwheel.geometry import Pose, from_wxyz
from cartwheel.simulation.snapshot import Scene, Snapshot
from cartwheel.viewer.model_view import ModelView
from cartwheel.viewer.page import Page

GRID = "/grid"


class SceneView:
    """Shows the snapshots of a simulation.

    Args:
        page: The page to draw on.
    """

    def __init__(self, page: Page) -> None:
        self._page = page
        self.clicked: Callable[[int, str], None] = lambda _, __: None
        """Called with a browser's number and the name of the clicked model."""
        self.models: dict[str, ModelView] = {}
        self.snapshot: Snapshot | None = None
        """The latest snapshot shown."""
        self._version = -1
        self._rows: dict[str, slice] = {}
        set_stage(page)
        add_grid(page)

    def update(self, snapshot: Snapshot) -> bool:
        """Shows a state; returns whether the set of models has changed."""
        changed = snapshot.scene.version != self._version
        with self._page.server.atomic():
            if changed:
                self._rebuild(snapshot.scene)
            for name, rows in self._rows.items():
                self.models[name].move(snapshot.positions[rows], snapshot.quaternions[rows])
        self.snapshot = snapshot
        return changed

    def pose(self, name: str) -> Pose | None:
        """Pose of a model's frame; None if the model does not exist."""
        if self.snapshot is None or name not in self._rows:
            return None
        return pose_in(self.snapshot, name)

    def _rebuild(self, scene: Scene) -> None:
        wanted = {placed.name: placed.description for placed in scene.models}
        for name in [n for n, view in self.models.items() if wanted.get(n) is not view.description]:
            self.models.pop(name).remove()
        for name, description in wanted.items():
            if name not in self.models:
                self.models[name] = self._add(name, description)
        self._rows = {}
        names = [model for model, _ in scene.links]
        for name, description in wanted.items():
            first = names.index(name)
            self._rows[name] = slice(first, first + len(description.links))
        self._version = scene.version

    def _add(self, name: str, description: RobotDescription) -> ModelView:
        def problem(error: CartwheelError) -> None:
            self._page.show_error(error)

        return ModelView(
            self._page.scene,
            name,
            description,
            problem=problem,
            clicked=self._page.on(lambda event: self.clicked(event.client_id, name)),
        )


def pose_in(snapshot: Snapshot, name: str) -> Pose:
    """Pose of a model's frame in a snapshot."""
    placed = next(model for model in snapshot.scene.models if model.name == name)
    row = snapshot.scene.links.index((name, placed.description.canonical_link))
    x, y, z = snapshot.positions[row].tolist()
    link = Pose((x, y, z), from_wxyz(snapshot.quaternions[row].tolist()))
    return link @ placed.description.canonical_pose.inverse()


def set_stage(page: Page) -> None:
    """Light from above and behind, soft light from all sides, to make shapes easy to see."""
    page.scene.world_axes.visible = False
    page.scene.configure_default_lights(enabled=True, cast_shadow=False)
    # Without a GPU, to prepare an environment map takes as long as 70 images.
    page.scene.configure_environment_map(None)
    page.scene.add_light_hemisphere(
        "/lights/sky",
        sky_color=(240, 244, 255),
        ground_color=(160, 156, 150),
        intensity=1.4,
        position=(0.0, 0.0, 1.0),
    )
    page.scene.add_light_directional("/lights/side", intensity=0.8, position=(6.0, -6.0, 3.0))
    camera = page.server.initial_camera
    camera.position = (-2.1, -2.5, 1.75)
    camera.look_at = (0.75, 0.0, 0.4)
    camera.fov = np.deg2rad(45.0)


def add_grid(page: Page) -> None:
    """A ground grid with lines every half metre and every metre."""
    page.scene.add_grid(
        GRID,
        infinite_grid=True,
        cell_size=0.5,
        section_size=1.0,
        cell_color=(206, 212, 219),
        section_color=(176, 185, 196),
        fade_distance=40.0,
        shadow_opacity=0.0,
    )
