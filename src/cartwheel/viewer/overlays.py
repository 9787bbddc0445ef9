"""Camera pyramids, the robot's trail, and the following camera."""

from __future__ import annotations

import math
import time
from collections import deque
from typing import Any

import numpy as np

from cartwheel.description.model import CameraIntrinsics, RobotDescription
from cartwheel.geometry import Array, Pose, to_wxyz
from cartwheel.simulation.snapshot import Snapshot
from cartwheel.viewer.every import Every
from cartwheel.viewer.page import Page
from cartwheel.viewer.scene_view import SceneView
from cartwheel.viewer.seat import Seat

_TRAIL_STEP = 0.03
"""Distance between two trail points, m."""
_TRAIL_POINTS = 1500
_OPTICAL = Pose.from_xyz_rpy((0, 0, 0), (-math.pi / 2, 0, -math.pi / 2))
"""REP 103's optical axes (z ahead, y down) in the camera's frame with x ahead."""


class Frustums:
    """Pyramids with the cameras' images, which each browser can hide.

    Args:
        page: The page to draw on.
        scene: The scene with the models.
    """

    def __init__(self, page: Page, scene: SceneView) -> None:
        self._page = page
        self._scene = scene
        self._pyramids: dict[tuple[str, str, str], Any] = {}
        self._image_due = Every(4)

    def show(self) -> None:
        """Updates the pyramids to the current models."""
        present = self._scene.models
        # The pyramids of deleted models were removed with them.
        self._pyramids = {k: v for k, v in self._pyramids.items() if k[0] in present}
        wanted: dict[tuple[str, str, str], tuple[RobotDescription, Pose, CameraIntrinsics]] = {}
        for name, view in self._scene.models.items():
            for link in view.description.links:
                for sensor in link.sensors:
                    for lens in sensor.cameras[:1]:
                        wanted[name, link.name, sensor.name] = (
                            view.description,
                            sensor.pose @ lens.pose @ _OPTICAL,
                            lens,
                        )
        for key in set(self._pyramids) - set(wanted):
            self._pyramids.pop(key).remove()
        for key, (_, pose, lens) in wanted.items():
            if key not in self._pyramids:
                self._pyramids[key] = self._pyramid(key, pose, lens)

    @property
    def nodes(self) -> list[str]:
        """Scene nodes of the pyramids."""
        return [pyramid.name for pyramid in self._pyramids.values()]

    def show_image(self, topic: str, picture: Any) -> None:
        """Shows a camera's image in its pyramid, a few times per second."""
        if not self._pyramids or not self._image_due(time.monotonic()):
            return
        parts = topic.split("/")
        named = [pyramid for key, pyramid in self._pyramids.items() if key[2] in parts]
        for pyramid in (named or list(self._pyramids.values()))[:1]:
            pyramid.image = picture[::2, ::2]

    def _pyramid(self, key: tuple[str, str, str], pose: Pose, lens: CameraIntrinsics) -> Any:
        aspect = lens.width / max(1, lens.height)
        vertical = 2 * math.atan(math.tan(min(lens.horizontal_fov, 2.8) / 2) / aspect)
        name, link, sensor = key
        view = self._scene.models[name]
        return self._page.scene.add_camera_frustum(
            f"{view.path(link)}/camera_{sensor.replace('/', '|')}",
            fov=vertical,
            aspect=aspect,
            scale=min(0.3, 0.25 * view.size),
            color=(37, 99, 176),
            cast_shadow=False,
            receive_shadow=False,
            format="jpeg",
            jpeg_quality=60,
            position=pose.position,
            wxyz=to_wxyz(pose.orientation),
        )


class Trail:
    """The path of the page's robot."""

    def __init__(self) -> None:
        self.points: deque[Array] = deque(maxlen=_TRAIL_POINTS)
        self._time_ns = 0

    def update(self, snapshot: Snapshot, pose: Pose | None) -> None:
        """Extends the trail; `pose` is None without a robot."""
        if snapshot.time_ns < self._time_ns:
            self.points.clear()
        self._time_ns = snapshot.time_ns
        if pose is None:
            return
        place = np.array(pose.position)
        if not self.points or float(np.linalg.norm(place - self.points[-1])) > _TRAIL_STEP:
            self.points.append(place)


class Overlays:
    """A browser's trail, and its camera if it follows the robot.

    Args:
        seat: The browser.
        trail: The robot's trail.
    """

    def __init__(self, seat: Seat, trail: Trail) -> None:
        self._seat = seat
        self._trail = trail
        self._line: Any = None
        self._drawn: Array | None = None
        self._line_due = Every(4)
        self._followed: Array | None = None

    def update(self, pose: Pose | None, now: float) -> None:
        """Updates the trail and the following camera.

        Args:
            pose: The robot's pose; None without a robot.
            now: Wall time, s.
        """
        self._draw_trail(now)
        self._follow(None if pose is None else np.array(pose.position))

    def _draw_trail(self, now: float) -> None:
        points = self._trail.points
        if not self._seat.display.trail or len(points) < 2:
            if self._line is not None:
                self._line.remove()
                self._line = self._drawn = None
            return
        if points[-1] is self._drawn or not self._line_due(now):
            return
        self._drawn = points[-1]
        flat = np.array(points, dtype=np.float32)
        flat[:, 2] = 0.012  # on the ground, so that the trail does not hide the robot
        segments = np.stack([flat[:-1], flat[1:]], axis=1)
        self._line = self._seat.scene.add_line_segments(
            "/trail", segments, (240, 140, 0), thickness=0.015
        )

    def _follow(self, place: Array | None) -> None:
        if not self._seat.display.follow or place is None or self._followed is None:
            self._followed = place
            return
        step = place - self._followed
        if float(np.linalg.norm(step)) < 1e-3:
            return
        self._followed = place
        client = self._seat.client
        with client.atomic():
            # Position first: setting it rotates the view, and setting the target rotates it back.
            position, target = client.camera.position + step, client.camera.look_at + step
            client.camera.position = position
            client.camera.look_at = target
