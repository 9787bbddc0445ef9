"""Whether a robot blocks the view of its own sensors."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np

from cartwheel.checks import nodes
from cartwheel.checks.robot import Robot
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.codes import devices as devices_codes
from cartwheel.description.model import CameraIntrinsics, Element, Sensor
from cartwheel.description.solids import Floats, Solid, first_hits, moved
from cartwheel.errors import Diagnostic
from cartwheel.geometry import Pose, matrix_from_quat

CAMERAS = (
    "camera", "depth", "depth_camera", "rgbd", "rgbd_camera", "multicamera", "wideanglecamera",
)  # fmt: skip
LASERS = ("ray", "gpu_ray", "lidar", "gpu_lidar")
BLOCKED = 0.6
"""Maximum fraction of blocked rays: a robot may see its bumper or mast, but not only itself."""
_GRID = 9


@rule(devices_codes.VIEW_BLOCKED)
def view_blocked(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        if not robot.is_placed:
            continue
        for link, sensor in robot.sensors():
            for view in _views(sensor):
                block = _blocked(robot, link.name, view)
                if block.share < BLOCKED:
                    continue
                part = "visual" if view.drawn else "collision"
                yield devices_codes.VIEW_BLOCKED.diagnostic(
                    message=f'the {view.kind} "{sensor.name}" is inside the {part} of link '
                    f'"{block.link}", so in Gazebo {block.share:.0%} of its rays end there '
                    f"after {block.distance:.3g} m"
                    if block.within
                    else f'{block.share:.0%} of the rays of the {view.kind} "{sensor.name}" '
                    f'end at the {part} of link "{block.link}", {block.distance:.3g} m in '
                    "front of the sensor",
                    values={
                        "sensor": sensor.name,
                        "link": block.link,
                        "within": block.within,
                        "share": block.share,
                        "distance": block.distance,
                    },
                    origin=sensor.origin,
                    hint=_way_out(view, block),
                    mark=f'name="{sensor.name}"',
                )


def _way_out(view: _View, block: _Block) -> str:
    farther = f"{math.ceil(1000 * block.farthest + 1) / 1000:g}"
    if view.kind == "camera":
        return (
            "Move the sensor with its <pose> or its link's joint, or increase the near distance to "
            f"more than {farther} m."
        )
    past = " Cartwheel ignores geometry that encloses a sensor." if block.within else ""
    return f"Move the sensor out of the geometry, or set <min> in its <range> to {farther}.{past}"


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class _View:
    kind: Literal["camera", "lidar"]
    pose: Pose
    """Pose in the link frame."""
    rays: Floats
    """Unit vectors in the sensor frame, shape (n, 3)."""
    near: float
    far: float
    """Maximum range, m."""
    drawn: bool
    """Whether the sensor sees visuals, which are single-sided, instead of collisions."""


@dataclass(frozen=True, kw_only=True)
class _Block:
    share: float
    """Fraction of the rays that hit the robot itself."""
    link: str = ""
    """The link that most of these rays hit."""
    distance: float = 0.0
    farthest: float = 0.0
    """Largest distance of such a hit, m."""
    within: bool = False
    """Whether the sensor is inside the geometry that it hits."""


def _views(sensor: Sensor) -> Iterator[_View]:
    if sensor.type in CAMERAS:
        for camera in sensor.cameras:
            yield _View(
                kind="camera",
                pose=sensor.pose @ camera.pose,
                rays=_camera_rays(camera),
                near=camera.near,
                far=camera.far,
                drawn=True,
            )
    elif sensor.type in LASERS:
        scan = sensor.element.find("ray") or sensor.element.find("lidar")
        if scan is not None:
            yield _View(
                kind="lidar",
                pose=sensor.pose,
                rays=_scan_rays(scan),
                near=_of(scan, "range/min", 0.0),
                far=_of(scan, "range/max", 10.0),
                drawn=sensor.type.startswith("gpu"),
            )


def _camera_rays(camera: CameraIntrinsics) -> Floats:
    half = math.tan(min(camera.horizontal_fov, 3.0) / 2)
    across = np.linspace(-half, half, _GRID)
    up = across * camera.height / camera.width
    y, z = np.meshgrid(across, up)
    rays = np.stack([np.ones(y.size), y.ravel(), z.ravel()], axis=1)
    return np.asarray(rays / np.linalg.norm(rays, axis=1, keepdims=True), dtype=np.float64)


def _scan_rays(scan: Element) -> Floats:
    yaw = np.linspace(
        _of(scan, "scan/horizontal/min_angle", 0.0), _of(scan, "scan/horizontal/max_angle", 0.0), 61
    )
    low = _of(scan, "scan/vertical/min_angle", 0.0)
    high = _of(scan, "scan/vertical/max_angle", 0.0)
    pitch = np.linspace(low, high, 3 if high > low else 1)
    a, b = np.meshgrid(yaw, pitch)
    across, up = a.ravel(), b.ravel()
    level = np.cos(up)
    rays = np.stack([level * np.cos(across), level * np.sin(across), np.sin(up)], axis=1)
    return np.asarray(rays, dtype=np.float64)


def _of(element: Element, path: str, default: float) -> float:
    found = element.find(path)
    value = nodes.number(found.text) if found is not None else None
    return default if value is None else value


def _blocked(robot: Robot, link: str, view: _View) -> _Block:
    frame = robot.links[link].pose @ view.pose
    directions = np.asarray(view.rays @ matrix_from_quat(frame.orientation).T, dtype=np.float64)
    origin = np.array(frame.position) + 0.0
    # Farther geometry is a deck or an arm, which a sensor may intentionally look down on.
    reach = min(view.far, max(2 * view.near, 0.3, 0.3 * robot.size))
    nearest = np.full(len(view.rays), np.inf)
    hit_by = np.full(len(view.rays), -1)
    placed: dict[int, Solid] = {}
    for index, (name, solid) in enumerate(_obstacles(robot, view)):
        vertices = moved(solid.vertices, robot.links[name].pose)
        if _beyond(vertices, origin, reach):
            continue
        placed[index] = Solid(part=solid.part, link=name, vertices=vertices, faces=solid.faces)
        # Surfaces in front of the near plane are clipped, so the geometry behind them is visible.
        # Visuals are single-sided; physics rays hit both sides.
        distances = first_hits(
            origin,
            directions,
            placed[index],
            beyond=view.near,
            within=reach,
            front_only=view.drawn,
        )
        closer = distances < nearest
        nearest[closer], hit_by[closer] = distances[closer], index
    seen = nearest < reach
    if not seen.any():
        return _Block(share=0.0)
    index = int(np.bincount(hit_by[seen]).argmax())
    solid, of_it = placed[index], seen & (hit_by == index)
    # A ray from inside hits a back face without hitting a front face before it.
    front = first_hits(origin, directions[of_it], solid, front_only=True)
    return _Block(
        share=float(seen.mean()),
        link=solid.link,
        distance=float(np.median(nearest[of_it])),
        farthest=float(nearest[seen].max()),
        within=bool(np.mean(front > nearest[of_it] + 1e-9) > 0.5),
    )


def _beyond(points: Floats, origin: Floats, reach: float) -> bool:
    low, high = points.min(axis=0), points.max(axis=0)
    away = np.maximum(np.maximum(low - origin, origin - high), 0.0)
    return float(np.linalg.norm(away)) > reach


def _obstacles(robot: Robot, view: _View) -> list[tuple[str, Solid]]:
    # Cameras and GPU lidars see visuals; physics rays hit collisions.
    kind = robot.visuals if view.drawn else robot.collisions
    return [(name, solid) for name, solids in kind.items() for solid in solids]
