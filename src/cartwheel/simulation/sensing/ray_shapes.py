"""Shapes for rays: triangles that enclose them, and exact distances to them.

All points, directions and distances are in the frame of the shape, in m. Directions are unit
vectors. A distance is that of the nearest surface in front of the start, also from inside a shape,
and inf if there is none.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import mujoco
import numpy as np

from cartwheel.geometry import Array

Triangles = tuple[Array, Any]
"""Corners, shape (n, 3), and the three corners of each triangle, shape (m, 3)."""

PLANE = int(mujoco.mjtGeom.mjGEOM_PLANE)
HFIELD = int(mujoco.mjtGeom.mjGEOM_HFIELD)
SPHERE = int(mujoco.mjtGeom.mjGEOM_SPHERE)
CAPSULE = int(mujoco.mjtGeom.mjGEOM_CAPSULE)
ELLIPSOID = int(mujoco.mjtGeom.mjGEOM_ELLIPSOID)
CYLINDER = int(mujoco.mjtGeom.mjGEOM_CYLINDER)
BOX = int(mujoco.mjtGeom.mjGEOM_BOX)
MESH = int(mujoco.mjtGeom.mjGEOM_MESH)
CURVED = (SPHERE, CAPSULE, ELLIPSOID, CYLINDER)

_GAP = 5e-5
"""Wanted distance between a curved surface and its triangles, m."""
_LEVEL = 1e-15
"""Rays that go down less than this miss planes."""
_ALONG = 1 - 1e-9
"""Cosine of the angle between an axis and rays that are almost along it."""
_MOST_SIDES = 96
_MOST_SPHERE_SIDES = 48
_BOX_CORNERS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
_BOX_FACES = np.array(
    [
        [0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
        [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3],
    ]
)  # fmt: skip


# -- triangles


def triangles_of(model: Any, geom: int) -> Triangles:
    """Triangles of a geom. Those of a curved shape enclose it.

    Args:
        model: The MuJoCo model.
        geom: Index of a geom, which is not a plane.
    """
    kind, size = int(model.geom_type[geom]), model.geom_size[geom]
    if kind == MESH:
        return _mesh(model, int(model.geom_dataid[geom]))
    if kind == HFIELD:
        return _heights(model, int(model.geom_dataid[geom]))
    if kind == BOX:
        return _BOX_CORNERS * size, _BOX_FACES
    if kind == CYLINDER:
        radius = size[0] / math.cos(math.pi / _sides(size[0], _MOST_SIDES))
        return _turned([(radius, -size[1]), (radius, size[1])], _sides(size[0], _MOST_SIDES))
    if kind == CAPSULE:
        corners, faces = _ball(size[0])
        corners = corners.copy()
        corners[:, 2] += np.where(corners[:, 2] > 0, size[1], -size[1])
        return corners, faces
    if kind == SPHERE:
        return _ball(size[0])
    if kind == ELLIPSOID:
        corners, faces = _ball(1.0, _sides(float(max(size)), _MOST_SPHERE_SIDES))
        return corners * size, faces
    raise ValueError(f"no triangles for geom type {kind}")


def box_planes(size: Array) -> tuple[Array, Array]:
    """Normals and distances from the centre of the planes of a box's triangles."""
    corners = _BOX_CORNERS[_BOX_FACES]
    # A triangle has one coordinate that its corners share.
    normals = np.where((corners == corners[:, :1]).all(axis=1), corners[:, 0], 0.0)
    return normals, np.abs(normals) @ size


def _mesh(model: Any, mesh: int) -> Triangles:
    first, count = model.mesh_vertadr[mesh], model.mesh_vertnum[mesh]
    face, faces = model.mesh_faceadr[mesh], model.mesh_facenum[mesh]
    corners = np.asarray(model.mesh_vert[first : first + count], float)
    return corners, np.array(model.mesh_face[face : face + faces])


def _heights(model: Any, field: int) -> Triangles:
    rows, columns = int(model.hfield_nrow[field]), int(model.hfield_ncol[field])
    half_x, half_y, top, base = model.hfield_size[field]
    first = model.hfield_adr[field]
    heights = model.hfield_data[first : first + rows * columns].reshape(rows, columns)
    x, y = np.meshgrid(np.linspace(-half_x, half_x, columns), np.linspace(-half_y, half_y, rows))
    upper = np.stack([x, y, heights.astype(float) * top], axis=-1).reshape(-1, 3)
    index = np.arange(rows * columns).reshape(rows, columns)
    a, b, c, d = index[:-1, :-1], index[:-1, 1:], index[1:, :-1], index[1:, 1:]
    cells = np.concatenate(
        [np.stack([a, b, d], -1).reshape(-1, 3), np.stack([a, d, c], -1).reshape(-1, 3)]
    )
    rim = np.concatenate([index[0], index[1:, -1], index[-1, -2::-1], index[-2:0:-1, 0]])
    lower = upper[rim] * (1.0, 1.0, 0.0) - (0.0, 0.0, base)
    below = len(upper) + np.arange(len(rim))
    after, below_after = np.roll(rim, -1), np.roll(below, -1)
    sides = np.concatenate(
        [np.stack([rim, below, below_after], -1), np.stack([rim, below_after, after], -1)]
    )
    corner = [
        below[0],
        below[columns - 1],
        below[columns + rows - 2],
        below[2 * columns + rows - 3],
    ]
    bottom = np.array([[corner[0], corner[1], corner[2]], [corner[0], corner[2], corner[3]]])
    return np.concatenate([upper, lower]), np.concatenate([cells, sides, bottom])


def _sides(radius: float, most: int) -> int:
    """Number of sides around a circle for the wanted gap, a multiple of 4."""
    angle = math.acos(radius / (radius + _GAP)) if radius > 0 else 1.0
    return int(min(most, max(12, 4 * math.ceil(math.pi / angle / 4))))


def _ball(radius: float, sides: int | None = None) -> Triangles:
    sides = sides or _sides(radius, _MOST_SPHERE_SIDES)
    # The planes of the faces of a sphere's triangles are inside it by both angles.
    outer = radius / math.cos(math.pi / sides) ** 2
    steep = np.linspace(-math.pi / 2, math.pi / 2, sides // 2 + 1)
    return _turned([(outer * math.cos(a), outer * math.sin(a)) for a in steep[1:-1]], sides, outer)


def _turned(profile: list[tuple[float, float]], sides: int, pole: float | None = None) -> Triangles:
    """A surface of revolution about z, closed at both ends.

    Args:
        profile: Radius and height of each ring, from below.
        sides: Number of corners of a ring.
        pole: Height of the points that close it; by default those of the outer rings.
    """
    around = 2 * math.pi * np.arange(sides) / sides
    circle = np.stack([np.cos(around), np.sin(around)], axis=-1)
    rings = [
        np.column_stack([radius * circle, np.full(sides, height)]) for radius, height in profile
    ]
    low, high = (profile[0][1], profile[-1][1]) if pole is None else (-pole, pole)
    corners = np.concatenate([*rings, [[0.0, 0.0, low], [0.0, 0.0, high]]])
    one = np.arange(sides)
    other = np.roll(one, -1)
    faces = []
    for ring in range(len(rings) - 1):
        first, second = ring * sides, (ring + 1) * sides
        faces.append(np.stack([first + one, first + other, second + other], -1))
        faces.append(np.stack([first + one, second + other, second + one], -1))
    last = (len(rings) - 1) * sides
    faces.append(np.stack([other, one, np.full(sides, len(corners) - 2)], -1))
    faces.append(np.stack([last + one, last + other, np.full(sides, len(corners) - 1)], -1))
    return corners, np.concatenate(faces)


# -- exact distances; all arguments have shape (n, 3), and callers ignore invalid operations. Roots
# of rays that miss a surface are NaN, which is neither above nor below any number.


def _dot(first: Array, second: Array) -> Array:
    """Scalar products. `sum` takes several times as long."""
    products = first * second
    found: Array = products[:, 0] + products[:, 1]
    found += products[:, 2]
    return found


def _first(near: Array, far: Array) -> Array:
    """The smaller root that is not negative."""
    found: Array = np.where(near >= 0, near, far)
    return np.where(found >= 0, found, np.inf)


def _to_sphere(start: Array, ray: Array, radius: Array) -> tuple[Array, Array]:
    """Both roots for spheres about the origin."""
    b = _dot(start, ray)
    root = np.sqrt(b * b - (_dot(start, start) - radius * radius))
    return -b - root, -b + root


def to_sphere(start: Array, ray: Array, size: Array) -> Array:
    """Distances to spheres of radius ``size[0]``."""
    return _first(*_to_sphere(start, ray, size[..., 0]))


def to_ellipsoid(start: Array, ray: Array, size: Array) -> Array:
    """Distances to ellipsoids with the half-axes ``size``."""
    start, ray = start / size, ray / size
    a = np.einsum("ij,ij->i", ray, ray)
    b = _dot(start, ray)
    root = np.sqrt(b * b - a * (_dot(start, start) - 1.0))
    return _first((-b - root) / a, (-b + root) / a)


def _to_side(start: Array, ray: Array, radius: Array) -> tuple[Array, Array]:
    """Both roots for an endless cylinder about z."""
    x, y, left, forward = start[:, 0], start[:, 1], ray[:, 0], ray[:, 1]
    a = left * left + forward * forward
    b = x * left + y * forward
    root = np.sqrt(b * b - a * (x * x + y * y - radius * radius))
    return (-b - root) / a, (-b + root) / a


def to_cylinder(start: Array, ray: Array, size: Array) -> Array:
    """Distances to cylinders of radius ``size[0]`` and half-length ``size[1]``."""
    near, far = _to_side(start, ray, size[:, 0])
    up = ray[:, 2]
    missed = ~((near >= 0) & (np.abs(start[:, 2] + near * up) <= size[:, 1]))
    near[missed] = np.inf
    # Other rays that cross the endless cylinder, or are along it, may enter through an end.
    missed &= (far >= 0) | (np.abs(up) > _ALONG)
    (which,) = missed.nonzero()
    if which.size:
        near[which] = _to_cap(start[which], ray[which], size[which], far[which])
    return near


def _to_cap(start: Array, ray: Array, size: Array, far: Array) -> Array:
    """As `to_cylinder`, for rays that do not enter through the side.

    Args:
        start: Where they start.
        ray: Their directions.
        size: Sizes of the cylinders.
        far: Where they leave the endless cylinders.
    """
    radius, half = size[:, 0], size[:, 1]
    height, up = start[:, 2], ray[:, 2]
    best: Array = np.where((far >= 0) & (np.abs(height + far * up) <= half), far, np.inf)
    for cap in (-half, half):
        root = (cap - height) / up
        x, y = start[:, 0] + root * ray[:, 0], start[:, 1] + root * ray[:, 1]
        inside = (root >= 0) & (x * x + y * y <= radius * radius)
        np.minimum(best, root, out=best, where=inside)
    return best


def to_capsule(start: Array, ray: Array, size: Array) -> Array:
    """Distances to capsules of radius ``size[0]`` and half-length ``size[1]``."""
    radius, half = size[..., 0], size[..., 1]
    best = np.full(len(ray), np.inf)
    for root in _to_side(start, ray, radius):
        inside = (root >= 0) & (np.abs(start[..., 2] + root * ray[:, 2]) <= half)
        np.minimum(best, root, out=best, where=inside)
    for side in (-1.0, 1.0):
        moved = start.copy()
        moved[..., 2] -= side * half
        for root in _to_sphere(moved, ray, radius):
            inside = (root >= 0) & (side * (moved[..., 2] + root * ray[:, 2]) >= 0)
            np.minimum(best, root, out=best, where=inside)
    return best


def to_box(start: Array, ray: Array, size: Array) -> Array:
    """Distances to boxes with the half-lengths ``size``."""
    one, other = (-size - start) / ray, (size - start) / ray
    low, high = np.minimum(one, other), np.maximum(one, other)
    # A ray along a face is NaN there, which `fmax` and `fmin` ignore.
    near = np.fmax(np.fmax(low[:, 0], low[:, 1]), low[:, 2])
    far = np.fmin(np.fmin(high[:, 0], high[:, 1]), high[:, 2])
    found: Array = np.where(near >= 0, near, far)
    return np.where((near <= far) & (far >= 0), found, np.inf)


def to_plane(
    start: Array, rays: Array, turn: Array, size: Array, maximum: float
) -> Array | None:  # fmt: skip
    """Distances from a point above to a rectangle in a plane; None if no ray hits it.

    Args:
        start: Where the rays start, from the centre of the rectangle, shape (3,).
        rays: Directions, shape (n, 3).
        turn: Rotation matrix of the rectangle, whose normal is z.
        size: Half-lengths; 0 is endless.
        maximum: Farther hits may be missing, m.
    """
    x, y, z = normal = turn[:, 2].tolist()
    height = float(start @ turn[:, 2])
    if height < 0:
        return None
    if normal == [0.0, 0.0, 1.0]:
        down = rays[:, 2]
    else:
        down = rays[:, 0] * x + rays[:, 1] * y + rays[:, 2] * z
    # Slightly farther hits are kept, so that this rounding has no effect.
    if down.min() >= -max(_LEVEL, height / maximum * (1 - 1e-9)):
        return None
    found: Array = np.where(down < -_LEVEL, -height / down, np.inf)
    for axis in (0, 1):
        if size[axis] > 0:
            across = rays[:, 0] * turn[0, axis] + rays[:, 1] * turn[1, axis]
            across += rays[:, 2] * turn[2, axis]
            inside = np.abs(float(start @ turn[:, axis]) + found * across) <= size[axis]
            found[~inside] = np.inf
    return found


TO_SHAPE: dict[int, Callable[[Array, Array, Array], Array]] = {
    SPHERE: to_sphere,
    ELLIPSOID: to_ellipsoid,
    CYLINDER: to_cylinder,
    CAPSULE: to_capsule,
    BOX: to_box,
}
