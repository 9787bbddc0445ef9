"""The robot's geometry as triangles, for geometric checks."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from cartwheel.description.meshes import MeshError, surface_of
from cartwheel.description.model import Collision, Mesh, Shape, Visual
from cartwheel.description.shapes.triangles import triangles_of
from cartwheel.geometry import Pose, matrix_from_quat

_ON_PLANE = 1e-6
"""m; tolerance for points on a plane of rays."""
Floats = NDArray[np.float64]
Ints = NDArray[np.int32]


@dataclass(frozen=True, kw_only=True, eq=False)
class Solid:
    """A visual or collision as triangles in its link's frame."""

    part: Visual | Collision
    link: str
    vertices: Floats
    """Shape (n, 3), m."""
    faces: Ints
    """Vertex indices, shape (m, 3)."""

    @cached_property
    def extent(self) -> float:
        """Longest edge of its bounding box along the link's axes, m."""
        return float(np.ptp(self.vertices, axis=0).max())

    def placed(self, pose: Pose) -> Floats:
        """The vertices in the frame in which `pose` is the link's pose."""
        return moved(self.vertices, pose)


def moved(points: Floats, pose: Pose) -> Floats:
    """Transforms points of shape (n, 3) from the frame at `pose` to the outer frame."""
    R = matrix_from_quat(pose.orientation)
    return np.asarray(points @ R.T + np.array(pose.position), dtype=np.float64)


def solid_of(part: Visual | Collision, link: str) -> Solid | None:
    """The triangles of a part; None for planes, terrain and unreadable meshes."""
    found = _triangles(part.shape)
    if found is None:
        return None
    vertices, faces = found
    return Solid(part=part, link=link, vertices=moved(vertices, part.pose), faces=faces)


def bounds(clouds: list[Floats]) -> tuple[Floats, Floats] | None:
    """Lowest and highest corner of the points' bounding box; None without points."""
    if not clouds:
        return None
    points = np.concatenate(clouds)
    return points.min(axis=0), points.max(axis=0)


def as_collision(part: Visual | Collision) -> Collision:
    """A visual converted to a collision."""
    if isinstance(part, Collision):
        return part
    return Collision(name=part.name, pose=part.pose, shape=part.shape, origin=part.origin)


def hull(solid: Solid) -> Solid:
    """The solid without duplicate vertices, which is enough for convex tests."""
    return replace(solid, vertices=np.unique(np.round(solid.vertices, 9), axis=0))


def _triangles(shape: Shape) -> tuple[Floats, Ints] | None:
    if not isinstance(shape, Mesh):
        return triangles_of(shape)
    try:
        vertices, faces = surface_of(shape)
    except MeshError:
        return None
    return vertices.astype(np.float64), faces.astype(np.int32)


def first_hits(
    origin: Floats,
    directions: Floats,
    solid: Solid,
    *,
    beyond: float = 0.0,
    within: float = np.inf,
    front_only: bool = False,
) -> Floats:
    """Distance of each ray to the first triangle that it hits; inf without a hit.

    Args:
        origin: Ray origin in the solid's link frame, shape (3,).
        directions: Unit vectors, shape (n, 3).
        solid: The triangles.
        beyond: Minimum distance of a hit from the origin, m.
        within: Maximum distance; farther hits may be missed, m.
        front_only: Ignore back faces.

    Returns:
        Distances, shape (n,), m.
    """
    result = np.full(len(directions), np.inf)
    corners = _in_the_way(origin, directions, solid.vertices[solid.faces], within)
    # Chunks limit the table of rays and triangles to some 10 MB.
    for start in range(0, len(corners), 4096):
        a, b, c = (corners[start : start + 4096, i] for i in range(3))
        ab, ac, to = b - a, c - a, origin - a
        # Möller-Trumbore: the ray parameter and the barycentric coordinates.
        normal = np.cross(ab, ac)
        with np.errstate(divide="ignore", invalid="ignore"):
            scale = -1.0 / (directions @ normal.T)
            distance = np.einsum("ij,ij->i", to, normal) * scale
            sideways = np.cross(to[None, :, :], directions[:, None, :])
            u = np.einsum("nij,ij->ni", sideways, ac) * scale
            v = -np.einsum("nij,ij->ni", sideways, ab) * scale
            inside = (u >= -1e-9) & (v >= -1e-9) & (u + v <= 1 + 1e-9) & (distance > beyond)
        if front_only:
            inside &= scale > 0
        distance = np.where(inside & np.isfinite(distance), distance, np.inf)
        if distance.size:
            result = np.minimum(result, distance.min(axis=1))
    return result


def _in_the_way(origin: Floats, directions: Floats, corners: Floats, within: float) -> Floats:
    """The triangles that rays may hit; omits those that obviously cannot be hit."""
    low, high = corners.min(axis=1), corners.max(axis=1)
    away = np.maximum(np.maximum(low - origin, origin - high), 0.0)
    corners = corners[np.einsum("ij,ij->i", away, away) <= within * within]
    axis = directions.mean(axis=0)
    if (directions @ axis > 0).all():  # All rays point into one half-space.
        corners = corners[(((corners - origin) @ axis) > 0).any(axis=1)]
    # Rays in one plane hit only triangles that cross it.
    _, spread, axes = np.linalg.svd(directions, full_matrices=True)
    if len(spread) < 3 or spread[2] < 1e-6:
        side = (corners - origin) @ axes[2]
        corners = corners[(side.min(axis=1) <= _ON_PLANE) & (side.max(axis=1) >= -_ON_PLANE)]
    return corners


def boxes_meet(a: Floats, b: Floats) -> bool:
    """Whether the bounding boxes of two point clouds touch or overlap."""
    return bool((a.min(axis=0) <= b.max(axis=0)).all() and (b.min(axis=0) <= a.max(axis=0)).all())


def overlap(a: Floats, b: Floats, shrink: float) -> bool:
    """Whether the convex hulls of two point clouds overlap by more than `shrink`.

    Searches for the point of the Minkowski difference that is nearest to the origin (Gilbert,
    Johnson and Keerthi), and stops at the first separating direction.

    Args:
        a: Shape (n, 3), m.
        b: Shape (m, 3), m.
        shrink: Minimum penetration depth, m.
    """
    simplex = (a[0] - b[0])[None, :]
    point = simplex[0]
    for _ in range(60):
        length = float(np.linalg.norm(point))
        if length < 1e-9:
            # The origin is inside, so the simplex's own directions are as good as any.
            return not _parted(a, b, simplex, shrink)
        direction = point / length
        nearest = a[np.argmin(a @ direction)] - b[np.argmax(b @ direction)]
        if float(nearest @ direction) > -shrink:
            return False
        point, simplex = _nearest_point(np.vstack([simplex, nearest]))
    return False


def distance(a: Floats, b: Floats) -> float:
    """Distance between the convex hulls of two point clouds, m; 0 if they overlap.

    Args:
        a: Shape (n, 3), m.
        b: Shape (m, 3), m.
    """
    simplex = (a[0] - b[0])[None, :]
    point, length = simplex[0], float(np.linalg.norm(simplex[0]))
    for _ in range(60):
        if length < 1e-9:
            return 0.0
        direction = point / length
        nearest = a[np.argmin(a @ direction)] - b[np.argmax(b @ direction)]
        if length - float(nearest @ direction) < 1e-9:
            break
        point, simplex = _nearest_point(np.vstack([simplex, nearest]))
        length = float(np.linalg.norm(point))
    return length


def _parted(a: Floats, b: Floats, simplex: Floats, shrink: float) -> bool:
    """Whether a candidate direction separates two clouds, up to an overlap of `shrink`."""
    normals = [np.eye(3)]
    for i, j, k in combinations(simplex, 3):
        normals.append(np.cross(j - i, k - i)[None, :])
    for normal in np.vstack(normals):
        length = float(np.linalg.norm(normal))
        if length < 1e-12:
            continue
        for direction in (normal / length, -normal / length):
            if float((a @ direction).min() - (b @ direction).max()) > -shrink:
                return True
    return False


def _nearest_point(simplex: Floats) -> tuple[Floats, Floats]:
    """The point in the convex hull of up to five points nearest to the origin, and its simplex."""
    best, spanned = min(
        ((p, p[None, :]) for p in simplex), key=lambda each: float(each[0] @ each[0])
    )
    for size in range(2, min(4, len(simplex)) + 1):
        for chosen in combinations(range(len(simplex)), size):
            corners = simplex[list(chosen)]
            edges = (corners[1:] - corners[0]).T
            weights = np.linalg.lstsq(edges, -corners[0], rcond=None)[0]
            if weights.min() < -1e-12 or weights.sum() > 1 + 1e-12:
                continue
            point = corners[0] + edges @ weights
            if float(point @ point) < float(best @ best):
                best, spanned = point, corners
    return best, spanned
