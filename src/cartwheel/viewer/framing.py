"""From where a browser looks at a robot first: near enough, and past what stands in between."""

from __future__ import annotations

import math

import numpy as np

from cartwheel.description.model import RobotDescription
from cartwheel.geometry import Pose, Vec3
from cartwheel.simulation.simulation import Simulation
from cartwheel.simulation.snapshot import Scene, Snapshot
from cartwheel.viewer.model_view import bounds
from cartwheel.viewer.page import Page
from cartwheel.viewer.scene_view import pose_in

_AHEAD = 0.4
"""Where the middle of the picture lies, in sizes before the robot: it shows what is there."""
_DISTANCE = 3.2
"""In sizes."""
_AZIMUTH = math.radians(-138.0)
"""Of the eye, against the robot's heading: behind it and to its right."""
_TURNS = (0, 45, -45, 90, -90, 135, -135, 180)
"""Degrees from there, in the order in which they are tried."""
_ELEVATIONS = (19.0, 45.0, 70.0)
"""Degrees, likewise."""
_SMALLEST, _LARGEST = 0.15, 30.0
"""m, of robots that are framed by their size."""


class Framing:
    """Aims at the first robot that there is, for browsers that come and for "Reset View".

    Args:
        page: Whose camera it is.
        simulation: That knows what stands in the way.
    """

    def __init__(self, page: Page, simulation: Simulation) -> None:
        self._page = page
        self._simulation = simulation
        self._robot: str | None = None

    def update(self, snapshot: Snapshot) -> None:
        """Aims anew where the first robot is another one than before."""
        robot = robot_of(snapshot.scene)
        if robot is None or robot == self._robot:
            return
        self._robot = robot
        placed = next(model for model in snapshot.scene.models if model.name == robot)
        target, eyes = views(placed.description, pose_in(snapshot, robot))

        def aim(clear: list[bool]) -> None:
            camera = self._page.server.initial_camera
            camera.position = next(
                (e for e, sees in zip(eyes, clear, strict=True) if sees), eyes[0]
            )
            camera.look_at = target

        in_sight = self._simulation.in_sight
        self._page.then(self._simulation.call(lambda: in_sight(robot, eyes, target)), aim)


def robot_of(scene: Scene) -> str | None:
    """The first model that does something by itself, else the first that can move."""
    movable = [model for model in scene.models if not model.description.static]
    active = [model for model in movable if _is_active(model.description)]
    return next((model.name for model in (*active, *movable)), None)


def _is_active(description: RobotDescription) -> bool:
    return bool(description.plugins) or any(link.sensors for link in description.links)


def views(description: RobotDescription, pose: Pose) -> tuple[Vec3, list[Vec3]]:
    """The point of a model to look at, and points to look from, the best first; m, in the world."""
    low, high = bounds(description) or (np.zeros(3), np.zeros(3))
    size = min(_LARGEST, max(_SMALLEST, float(np.max(high - low))))
    x, y, z = pose.apply(((low + high) / 2).tolist())
    heading = pose.yaw
    target = (
        x + _AHEAD * size * math.cos(heading),
        y + _AHEAD * size * math.sin(heading),
        z,
    )
    eyes = []
    for elevation in map(math.radians, _ELEVATIONS):
        for turn in map(math.radians, _TURNS):
            azimuth = heading + _AZIMUTH + turn
            reach = _DISTANCE * size * math.cos(elevation)
            eyes.append(
                (
                    target[0] + reach * math.cos(azimuth),
                    target[1] + reach * math.sin(azimuth),
                    target[2] + _DISTANCE * size * math.sin(elevation),
                )
            )
    return target, eyes
