"""Wheels: a body with unlimited rotation about its own axis touches the ground like a tyre.

A cylinder meets the ground at two points, the ends of a line. In a turn, both must slide in
opposite directions, and any traction makes one of them stick. The wheel then pivots about one end
or the other, which changes the cart's heading. An ellipsoid with the same radius and width touches
in the middle.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from cartwheel.description.meshes import MeshError, surface_of
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
"""Minimum radius of a faceted wheel in any direction, relative to its radius: twelve facets pass.
"""
_TREAD = 0.9
"""Fraction of the radius beyond which a mesh is its tread, which defines the tyre's width."""
_DIRECTIONS = 72
_CENTRED, _ALONG = 0.1, 0.999
"""Maximum offset from the axis, relative to a cylinder's radius, and minimum cosine between both
axes. Slightly misaligned wheels are wheels, and stay misaligned.
"""
_TRAIL = 0.05
"""Minimum trail of a caster, relative to its radius, with which it follows the motion."""
_PARALLEL = 0.9
"""Minimum cosine between the axles of wheels that roll in the same direction."""
_LEVEL = 0.5
"""Minimum cosine between an axle and the vertical at which a body does not roll: rotors, lasers,
turrets.
"""


@dataclass(frozen=True, slots=True)
class Axle:
    """The axis of a link with unlimited rotation, in the link's frame."""

    axis: Vec3
    """Unit vector."""
    point: Vec3

    def seen_from(self, pose: Pose) -> Axle:
        """The axle in the frame of another link with the given pose in this frame."""
        inverse = pose.inverse()
        return Axle(rotate(inverse.orientation, self.axis), inverse.apply(self.point))


def axle_of(joint: Joint | None) -> Axle | None:
    """A joint's axle if it turns like a wheel; see `Joint.turns`."""
    if joint is None or not joint.turns:
        return None
    return Axle(rotate(joint.pose.orientation, joint.axis.xyz), joint.pose.position)


def tyre(collision: Collision, axle: Axle | None) -> tuple[Shape, Pose]:
    """The collision shape and its pose in the link: an ellipsoid for a wheel.

    Args:
        collision: A collision of the rotating link, or of a link fixed to it.
        axle: The axle.
    """
    shape, pose = collision.shape, collision.pose
    if axle is not None and isinstance(shape, Cylinder) and _on(axle, shape, pose):
        return Ellipsoid(radii=(shape.radius, shape.radius, shape.length / 2)), pose
    if axle is not None and isinstance(shape, Mesh):
        return _round_mesh(shape, pose, axle) or (shape, pose)
    return shape, pose


Steering = Literal["not", "freely", "by motors"]
"""Whether a wheel's axle turns about the vertical, and whether a motor turns it."""


@dataclass(frozen=True, slots=True)
class Tread:
    """Where a wheel may touch the ground, in its model; m."""

    centre: Vec3
    radius: float
    axis: Vec3
    """Unit vector along the axle."""
    steered: Steering
    """Whether joints above the wheel turn its axle about the vertical."""
    driven: bool = False
    """Whether a motor turns it."""
    carried: bool = False
    """Whether it is mounted on another wheel, like the rollers of a mecanum wheel."""
    trail: float = math.inf
    """Horizontal distance between the centre and the axis that steers it; infinite without one."""

    @property
    def bottom(self) -> float:
        """Height of the lowest point."""
        return self.centre[2] - self.radius

    def rolls_beside(self, driven: Tread) -> bool:
        """Whether it rolls in the direction in which a driven wheel moves the base."""
        u, v = (each.axis[:2] for each in (self, driven))
        lengths = math.hypot(*u) * math.hypot(*v)
        return abs(u[0] * v[0] + u[1] * v[1]) > _PARALLEL * lengths

    @property
    def follows_nothing(self) -> bool:
        """Whether it is a caster below its swivel axis, which friction does not turn."""
        return self.steered == "freely" and not self.driven and self.trail < _TRAIL * self.radius

    def scrubs_beside(self, other: Tread) -> bool:
        """Whether one of two wheels must slip sideways in a turn: their axles are not in line."""
        if self.steered != "not" or other.steered != "not":
            return False
        x, y, _ = (a - b for a, b in zip(other.centre, self.centre, strict=True))
        u, v, _ = self.axis
        return abs(x * v - y * u) > _CENTRED * self.radius * math.hypot(u, v)


def tread_of(
    shape: Shape,
    pose: Pose,
    axle: Axle,
    *,
    steered: Steering,
    pivot: Vec3 | None,
    driven: bool,
    carried: bool,
) -> Tread | None:
    """A wheel's tread; None for rotating bodies that do not roll.

    Args:
        shape: Collision shape, as returned by `tyre`.
        pose: Pose in the model, in which the axle is also given.
        axle: The axle.
        steered: Whether joints above the wheel turn its axle about the vertical.
        pivot: A point on the axis of the last of these joints in the model; None without one.
        driven: Whether a motor turns the wheel.
        carried: Whether the wheel is mounted on another one.
    """
    match shape:
        case Ellipsoid(radii=radii):
            radius = max(radii)
        case Sphere(radius=radius):
            pass
        case _:
            return None
    if is_upright(axle.axis):
        return None
    x, y, _ = pose.position
    trail = math.inf if pivot is None else math.hypot(x - pivot[0], y - pivot[1])
    return Tread(pose.position, radius, axle.axis, steered, driven, carried, trail)


def is_upright(axis: Vec3) -> bool:
    """Whether a rotation about this axis of the model steers rather than rolls."""
    return abs(axis[2]) > _LEVEL


def lowest(shape: Shape, pose: Pose) -> float:
    """Height of a shape's lowest point at a pose, m; infinite if its mesh cannot be read."""
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
                points, _ = surface_of(shape)
            except MeshError:
                return math.inf  # reported when the shape is created
            depth = -float((points @ down).min()) if len(points) else -math.inf
        case _:
            return math.inf
    return pose.position[2] - depth


def _on(axle: Axle, shape: Cylinder, pose: Pose) -> bool:
    """Whether the axle is the cylinder's axis."""
    own = rotate(pose.orientation, (0.0, 0.0, 1.0))
    along = sum(a * b for a, b in zip(axle.axis, own, strict=True))
    arm = [a - b for a, b in zip(pose.position, axle.point, strict=True)]
    on_axis = sum(a * b for a, b in zip(arm, axle.axis, strict=True))
    off_axis = math.sqrt(max(0.0, sum(a * a for a in arm) - on_axis**2))
    return abs(along) >= _ALONG and off_axis <= _CENTRED * shape.radius


def _round_mesh(mesh: Mesh, pose: Pose, axle: Axle) -> tuple[Shape, Pose] | None:
    """The ellipsoid for a mesh that is round about the axle; None for other meshes."""
    try:
        points, _ = surface_of(mesh)
    except MeshError:
        return None  # reported when the shape is created
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
    # A disc without width could not stand.
    half = max((high - low) / 2, 0.05 * radius)
    return Ellipsoid(radii=(radius, radius, half)), frame @ Pose((0.0, 0.0, (low + high) / 2))
