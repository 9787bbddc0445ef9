"""The initial view of a robot: near enough, and not blocked by other models."""

from __future__ import annotations

import math

import numpy as np

from cartwheel.description.model import RobotDescription
from cartwheel.geometry import Pose, Vec3
from cartwheel.interfaces import RunningSimulation
from cartwheel.simulation.snapshot import Scene, Snapshot
from cartwheel.viewer.model_view import bounds
from cartwheel.viewer.page import Page
from cartwheel.viewer.scene_view import pose_in

_AHEAD = 0.4
"""Offset of the target point ahead of the robot, in robot sizes."""
_DISTANCE = 3.2
"""Distance of the camera, in robot sizes."""
_AZIMUTH = math.radians(-138.0)
"""Azimuth of the camera relative to the robot's heading: behind it and to its right."""
_TURNS = (0, 45, -45, 90, -90, 135, -135, 180)
"""Azimuth offsets in degrees, in the order in which they are tried."""
_ELEVATIONS = (19.0, 45.0, 70.0)
"""Elevations in degrees, in the order in which they are tried."""
_SMALLEST, _LARGEST = 0.15, 30.0
"""m; limits of the robot size used for framing."""


class Framing:
    """Points the camera at the first robot, for new browsers and for "Reset View".

    Args:
        page: The page with the camera.
        simulation: Tests the line of sight.
    """

    def __init__(self, page: Page, simulation: RunningSimulation) -> None:
        self._page = page
        self._simulation = simulation
        self._robot: str | None = None

    def update(self, snapshot: Snapshot) -> None:
        """Updates the view if the first robot has changed."""
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
        self._page.then(self._simulation.read(lambda: in_sight(robot, eyes, target)), aim)


def robot_of(scene: Scene) -> str | None:
    """The first model with active parts, or the first movable model."""
    movable = [model for model in scene.models if not model.description.static]
    active = [model for model in movable if _is_active(model.description)]
    return next((model.name for model in (*active, *movable)), None)


def _is_active(description: RobotDescription) -> bool:
    return bool(description.plugins) or any(link.sensors for link in description.links)


def views(description: RobotDescription, pose: Pose) -> tuple[Vec3, list[Vec3]]:
    """The point to look at and possible viewpoints, the best first; m, in the world."""
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
