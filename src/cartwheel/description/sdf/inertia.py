"""Mass and inertia of ``<inertial auto="true">``: from the collisions and their density."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cartwheel.description.meshes import convex_hull_input, load_mesh
from cartwheel.description.model import (
    Box,
    Capsule,
    Collision,
    Cone,
    Cylinder,
    Ellipsoid,
    Inertial,
    Mesh,
    Polyline,
    Shape,
    Sphere,
)
from cartwheel.description.outline import solid
from cartwheel.errors import Origin
from cartwheel.geometry import Pose, matrix_from_quat

Array = NDArray[np.float64]
WATER = 1000.0
"""kg/m³, SDF's default density."""


def inertial_of(
    collisions: list[Collision], densities: list[float], origin: Origin
) -> Inertial | None:
    """Mass, centre of mass and inertia of solid bodies; overlaps count twice, as in Gazebo.

    Args:
        collisions: The link's.
        densities: Of each, kg/m³.
        origin: The ``<inertial>``.

    Returns:
        None where no collision has a volume.
    """
    parts: list[tuple[float, Array, Array]] = []
    for collision, density in zip(collisions, densities, strict=True):
        volume, centre, tensor = _solid(collision.shape)
        if volume <= 0:
            continue
        R = matrix_from_quat(collision.pose.orientation)
        parts.append(
            (
                density * volume,
                np.array(collision.pose.apply(centre.tolist())),
                density * (R @ tensor @ R.T),
            )
        )
    mass = sum(part[0] for part in parts)
    if mass <= 0:
        return None
    com = sum((m * c for m, c, _ in parts), np.zeros(3)) / mass
    total = np.zeros((3, 3))
    for m, c, tensor in parts:
        r = c - com
        total += tensor + m * (float(r @ r) * np.eye(3) - np.outer(r, r))
    return Inertial(
        mass=float(mass),
        pose=Pose((float(com[0]), float(com[1]), float(com[2]))),
        ixx=float(total[0, 0]),
        iyy=float(total[1, 1]),
        izz=float(total[2, 2]),
        ixy=float(total[0, 1]),
        ixz=float(total[0, 2]),
        iyz=float(total[1, 2]),
        origin=origin,
    )


def _solid(shape: Shape) -> tuple[float, Array, Array]:
    """Volume, centroid, and inertia about it at density one, in the shape's frame."""
    centre = np.zeros(3)
    match shape:
        case Box(size=(x, y, z)):
            volume = x * y * z
            moments = [(y * y + z * z) / 12, (x * x + z * z) / 12, (x * x + y * y) / 12]
        case Sphere(radius=r):
            volume = 4 / 3 * math.pi * r**3
            moments = [0.4 * r * r] * 3
        case Ellipsoid(radii=(a, b, c)):
            volume = 4 / 3 * math.pi * a * b * c
            moments = [(b * b + c * c) / 5, (a * a + c * c) / 5, (a * a + b * b) / 5]
        case Cylinder(radius=r, length=h):
            volume = math.pi * r * r * h
            side = (3 * r * r + h * h) / 12
            moments = [side, side, r * r / 2]
        case Cone(radius=r, length=h):
            volume = math.pi * r * r * h / 3
            centre = np.array([0, 0, -h / 4])  # a quarter of the height above the base
            side = 3 / 80 * (4 * r * r + h * h)
            moments = [side, side, 0.3 * r * r]
        case Capsule(radius=r, length=h):
            cylinder, ball = math.pi * r * r * h, 4 / 3 * math.pi * r**3
            volume = cylinder + ball
            # Each half ball about its own centroid, 3r/8 beyond the cylinder's end.
            side = cylinder * (3 * r * r + h * h) / 12
            side += ball * (0.4 * r * r + h * h / 4 + 3 / 8 * h * r)
            moments = [side / volume, side / volume]
            moments.append((cylinder * r * r / 2 + ball * 0.4 * r * r) / volume)
        case Mesh():
            return _mesh(*convex_hull_input(load_mesh(shape)))
        case Polyline():
            return _mesh(*solid(shape))
        case _:
            return 0.0, centre, np.zeros((3, 3))
    return volume, centre, np.diag(moments) * volume


def _mesh(vertices: NDArray[Any], faces: NDArray[Any]) -> tuple[float, Array, Array]:
    """By the signed tetrahedra between the origin and each triangle of a closed surface."""
    corners = vertices.astype(np.float64)[faces]
    volumes = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6
    volume = float(volumes.sum())
    if volume <= 0:
        return 0.0, np.zeros(3), np.zeros((3, 3))
    sums = corners.sum(axis=1)
    centre = (volumes[:, None] * sums).sum(axis=0) / (4 * volume)
    # The second moments of a tetrahedron with one corner at the origin.
    squares = np.einsum("n,nij,nik->jk", volumes, corners, corners)
    squares = (squares + np.einsum("n,nj,nk->jk", volumes, sums, sums)) / 20
    squares -= volume * np.outer(centre, centre)
    return volume, centre, np.trace(squares) * np.eye(3) - squares
