"""The plane on which a rigid robot stands."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from cartwheel.checks.robot import Robot
from cartwheel.description.kinematics import center_of_mass, link_poses
from cartwheel.description.model import Capsule, Cylinder, Ellipsoid, Shape, Sphere
from cartwheel.description.solids import Floats
from cartwheel.dialects.ros_control.interfaces import ros2_control
from cartwheel.errors import PluginError
from cartwheel.geometry import Pose, cross, matrix_from_quat

_STEPS = 100
"""Maximum number of exchanged points; robots take about ten."""
_STEEPEST = 0.95
"""Minimum vertical component of the plane's normal; robots on steeper planes tip over first."""
_EXACT = 1e-6
"""Maximum depth of a point below the plane, m."""


@dataclass(frozen=True, slots=True)
class Rest:
    """The ground, as seen from the robot."""

    normal: Floats
    """Unit vector of shape (3,) in the model frame."""
    offset: float
    """Distance of the plane from the model frame's origin along the normal, m."""

    def height(self, robot: Robot, links: Iterable[str]) -> float | None:
        """Height of the lowest point of some links above the plane, m; None without collisions."""
        point = Surfaces(robot, links).lowest(self.normal)
        return None if point is None else float(self.normal @ point - self.offset)


def starting_positions(robot: Robot, *, commanded: bool = True) -> dict[str, float]:
    """Positions of the joints that do not start at 0, by name, rad or m.

    A joint starts at the initial value of its ros2_control interface, if it is `commanded`, or at
    0, or else at its limit that is nearest to this position.
    """
    initial = initial_positions(robot) if commanded else {}
    return initial | {
        joint.name: min(max(initial.get(joint.name, 0.0), joint.axis.lower), joint.axis.upper)
        for joint in robot.description.joints
        if joint.type in ("revolute", "prismatic")
        and joint.axis.lower is not None
        and joint.axis.upper is not None
        and not joint.axis.lower <= initial.get(joint.name, 0.0) <= joint.axis.upper
    }


def starting_poses(robot: Robot, *, commanded: bool = True) -> Mapping[str, Pose]:
    """Poses of the links with each joint where it starts, by name; see `starting_positions`."""
    positions = starting_positions(robot, commanded=commanded)
    if not any(positions.values()):
        return {link.name: link.pose for link in robot.description.links}
    return link_poses(robot.description, positions)


def initial_positions(robot: Robot) -> dict[str, float]:
    """Positions at which simulated ros2_control starts joints, by name, rad or m."""
    if not any("ros2_control" in tag.filename for tag in robot.description.plugins):
        return {}
    try:
        joints, _, _ = ros2_control(robot.description)
    except PluginError:
        return {}
    return {
        each.name: each.initial_position for each in joints if each.initial_position is not None
    }


class Surfaces:
    """The collisions of some links, with all joints at 0.

    Spheres, cylinders and ellipsoids are exact: a cylinder of 32 corners may be 0.5 % of its radius
    too high.
    """

    def __init__(self, robot: Robot, links: Iterable[str]) -> None:
        corners: list[Floats] = [np.empty((0, 3))]
        radii, halves, turns, centers = [], [], [], []
        for name in links:
            for solid in robot.collisions[name]:
                smooth = _smooth(solid.part.shape)
                if smooth is None:
                    corners.append(solid.placed(robot.links[name].pose))
                    continue
                pose = robot.links[name].pose @ solid.part.pose
                radii.append(smooth[0])
                halves.append(smooth[1])
                turns.append(matrix_from_quat(pose.orientation))
                centers.append(pose.position)
        self._corners = np.concatenate(corners)
        self._radii = np.array(radii).reshape(-1, 3)
        self._halves = np.array(halves)
        self._turns = np.array(turns).reshape(-1, 3, 3)
        self._centers = np.array(centers).reshape(-1, 3)

    def lowest(self, normal: Floats) -> Floats | None:
        """The point of shape (3,) that is furthest against the normal; None without collisions."""
        local = np.einsum("kij,i->kj", self._turns, normal)
        length = np.linalg.norm(self._radii * local, axis=1, keepdims=True)
        points = -(self._radii**2) * local / np.maximum(length, 1e-300)
        # The middle of a cylinder that lies on its side.
        along = np.where(np.abs(local[:, 2]) > 1e-9, np.sign(local[:, 2]), 0.0)
        points[:, 2] -= along * self._halves
        points = np.einsum("kij,kj->ki", self._turns, points) + self._centers
        found = [each[(each @ normal).argmin()] for each in (self._corners, points) if len(each)]
        return min(found, key=lambda each: float(each @ normal), default=None)


def _smooth(shape: Shape) -> tuple[tuple[float, float, float], float] | None:
    """A round shape as an ellipsoid that is moved by a length up and down its z axis, m."""
    match shape:
        case Sphere(radius=r):
            return (r, r, r), 0.0
        case Capsule(radius=r, length=length):
            return (r, r, r), length / 2
        case Cylinder(radius=r, length=length):
            return (r, r, 0.0), length / 2
        case Ellipsoid(radii=radii):
            return radii, 0.0
    return None


def rest_of(robot: Robot, links: Iterable[str]) -> Rest | None:
    """The plane on which the robot stands: the face of its lower hull below its centre of mass.

    The plane is below all points, and of such planes the highest below the centre of mass. The
    search starts with a triangle high above the robot around the centre of mass. It exchanges one
    corner at a time for the point furthest below the triangle, so that the centre of mass remains
    inside.

    Args:
        robot: The robot. Its centre of mass is that with each joint at 0, or at its nearest limit.
        links: Links that can carry the robot, whose joints are at 0.

    Returns:
        None if the robot has no mass, tips over, or if the plane is not found in `_STEPS` steps.
    """
    center = center_of_mass(robot.description, starting_poses(robot))
    size = robot.size
    if center is None or size <= 0:
        return None
    surfaces = Surfaces(robot, links)
    angles = np.array([0.0, 2.0, 4.0]) * np.pi / 3
    around = np.stack([np.cos(angles), np.sin(angles), np.full(3, 100.0)], axis=1)
    corners, holders = center + 10 * size * around, [False] * 3
    for _ in range(_STEPS):
        normal = cross(corners[1] - corners[0], corners[2] - corners[0])
        normal *= np.sign(normal[2]) / (np.linalg.norm(normal) or 1.0)
        offset = float(normal @ corners[0])
        point = surfaces.lowest(normal)
        if point is None or not normal[2]:
            return None
        if normal @ point >= offset - _EXACT:
            stands = holders == [True] * 3 and normal[2] >= _STEEPEST
            return Rest(normal=normal, offset=offset) if stands else None
        inside = [_inside(_exchanged(corners, i, point), center) for i in range(3)]
        i = int(np.argmax(inside))
        corners = _exchanged(corners, i, point)
        holders[i] = True
    return None


def _exchanged(corners: Floats, i: int, point: Floats) -> Floats:
    changed = corners.copy()
    changed[i] = point
    return changed


def _inside(triangle: Floats, center: Floats) -> float:
    """Smallest barycentric coordinate of a point, from above: 0 or more if it is inside."""
    (ax, ay), (bx, by), (cx, cy) = triangle[:, :2].tolist()
    x, y = (center[:2]).tolist()
    area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay)
    if not abs(area) >= 1e-15:
        return -math.inf
    u = ((x - ax) * (cy - ay) - (cx - ax) * (y - ay)) / area
    v = ((bx - ax) * (y - ay) - (x - ax) * (by - ay)) / area
    return float(min(u, v, 1 - u - v))
