"""Wheels: what turns without end about its own axis touches the ground as a tyre does.

A cylinder meets the ground in two points, at the ends of a line. In a turn both must slide, in
opposite senses, and any traction then makes one of them stick: the wheel turns about the one
or the other end and the cart's heading depends on which. A crowned tyre, an ellipsoid of the
same radius and width, touches in the middle.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from cartwheel.description.meshes import MeshError, convex_hull_input, load_mesh
from cartwheel.description.model import (
    Box,
    Capsule,
    Collision,
    Cone,
    Cylinder,
    Ellipsoid,
    Joint,
    Mesh,
    Shape,
    Sphere,
)
from cartwheel.geometry import Pose, Vec3, matrix_from_quat, quat_between, rotate

_ROUND = 0.96
"""Of its radius that a wheel of flat pieces reaches at least in every direction: twelve do."""
_TREAD = 0.9
"""Of its radius from where on a mesh counts as the tread, whose width is the tyre's."""
_DIRECTIONS = 72
_CENTRED, _ALONG = 0.1, 0.999
"""Of a cylinder's radius that it may lie off the axis, and the cosine between the two: wheels
that are drawn a little askew are wheels, and stay askew."""
_LEVEL = 0.5
"""Cosine between an axle and the vertical from which on nothing rolls: rotors, lasers, turrets."""


@dataclass(frozen=True, slots=True)
class Axle:
    """What a link turns about without end, in the link's frame."""

    axis: Vec3
    """Of unit length."""
    point: Vec3

    def seen_from(self, pose: Pose) -> Axle:
        """The same in the frame of another link, whose pose in this one is given."""
        inverse = pose.inverse()
        return Axle(rotate(inverse.orientation, self.axis), inverse.apply(self.point))


def axle_of(joint: Joint | None) -> Axle | None:
    """A joint's axle where it turns without end: in SDF a revolute one without limits does."""
    if joint is None:
        return None
    unlimited = joint.axis.lower is None and joint.axis.upper is None
    if joint.type != "continuous" and not (joint.type == "revolute" and unlimited):
        return None
    return Axle(rotate(joint.pose.orientation, joint.axis.xyz), joint.pose.position)


def tyre(collision: Collision, axle: Axle | None) -> tuple[Shape, Pose]:
    """The shape that collides, and its pose in the link: a wheel's is crowned.

    Args:
        collision: Of the link that turns, or of one that is fixed to it.
        axle: What it turns about.
    """
    shape, pose = collision.shape, collision.pose
    if axle is not None and isinstance(shape, Cylinder) and _on(axle, shape, pose):
        return Ellipsoid(radii=(shape.radius, shape.radius, shape.length / 2)), pose
    if axle is not None and isinstance(shape, Mesh):
        return _round_mesh(shape, pose, axle) or (shape, pose)
    return shape, pose


@dataclass(frozen=True, slots=True)
class Tread:
    """Where a wheel may touch the ground, in its model; m."""

    bottom: float
    radius: float


def tread_of(shape: Shape, pose: Pose, axle: Axle) -> Tread | None:
    """A wheel's tread; None for what turns without end and rolls on nothing.

    Args:
        shape: That collides, as `tyre` has it.
        pose: Its in the model, and so are the axle's.
        axle: What it turns about.
    """
    match shape:
        case Ellipsoid(radii=radii):
            radius = max(radii)
        case Sphere(radius=radius):
            pass
        case _:
            return None
    if abs(axle.axis[2]) > _LEVEL:
        return None
    return Tread(pose.position[2] - radius, radius)


def lowest(shape: Shape, pose: Pose) -> float:
    """How low a shape reaches at a pose, m; infinite where its mesh cannot be read."""
    down = matrix_from_quat(pose.orientation)[2]
    match shape:
        case Box(size=size):
            depth = float(np.abs(down) @ np.array(size)) / 2
        case Sphere(radius=radius):
            depth = radius
        case Ellipsoid(radii=radii):
            depth = float(np.linalg.norm(down * np.array(radii)))
        case Capsule(radius=radius, length=length):
            depth = radius + abs(float(down[2])) * length / 2
        case Cylinder(radius=radius, length=length) | Cone(radius=radius, length=length):
            depth = radius * math.hypot(*down[:2]) + abs(float(down[2])) * length / 2
        case Mesh():
            try:
                points, _ = convex_hull_input(load_mesh(shape))
            except MeshError:
                return math.inf  # told where the shape is made
            depth = -float((points @ down).min()) if len(points) else -math.inf
        case _:
            return math.inf
    return pose.position[2] - depth


def _on(axle: Axle, shape: Cylinder, pose: Pose) -> bool:
    """Whether the axle is the cylinder's own axis."""
    own = rotate(pose.orientation, (0.0, 0.0, 1.0))
    along = sum(a * b for a, b in zip(axle.axis, own, strict=True))
    arm = [a - b for a, b in zip(pose.position, axle.point, strict=True)]
    on_axis = sum(a * b for a, b in zip(arm, axle.axis, strict=True))
    off_axis = math.sqrt(max(0.0, sum(a * a for a in arm) - on_axis**2))
    return abs(along) >= _ALONG and off_axis <= _CENTRED * shape.radius


def _round_mesh(mesh: Mesh, pose: Pose, axle: Axle) -> tuple[Shape, Pose] | None:
    """A mesh that is round about the axle, as a crowned tyre; None for any other."""
    try:
        points, _ = convex_hull_input(load_mesh(mesh))
    except MeshError:
        return None  # told where the shape is made
    if not len(points):
        return None
    turn = quat_between((0.0, 0.0, 1.0), axle.axis)
    frame = Pose(axle.point, turn)
    to_frame = frame.inverse() @ pose
    points = points @ matrix_from_quat(to_frame.orientation).T + np.array(to_frame.position)
    away = np.hypot(points[:, 0], points[:, 1])
    radius = float(away.max())
    angles = np.linspace(0.0, 2 * math.pi, _DIRECTIONS, endpoint=False)
    reach = (points[:, :2] @ np.array([np.cos(angles), np.sin(angles)])).max(axis=0)
    if radius <= 0.0 or reach.min() < _ROUND * radius:
        return None
    tread = points[away >= _TREAD * radius, 2]
    low, high = float(tread.min()), float(tread.max())
    # A disc without width has nothing to stand on.
    half = max((high - low) / 2, 0.05 * radius)
    return Ellipsoid(radii=(radius, radius, half)), frame @ Pose((0.0, 0.0, (low + high) / 2))
