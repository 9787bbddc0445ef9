"""Boxes and solids of revolution as triangles."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from cartwheel.description.model import Box, Capsule, Cone, Cylinder, Ellipsoid, Shape, Sphere

Vertices = NDArray[np.float64]
Faces = NDArray[np.int32]
_AROUND = 32
"""Segments in a circle: smooth enough for a wheel, light enough for many robots."""
_UP = 16
"""Segments from pole to pole; even, so that a sphere has an equator."""


def triangles_of(shape: Shape) -> tuple[Vertices, Faces] | None:
    """The surface of a primitive in its own frame; None for other shapes.

    Returns:
        Vertices of shape (n, 3) in m, and faces of shape (m, 3), counter-clockwise from outside.
        Smooth surfaces share vertices, and sharp edges do not.
    """
    match shape:
        case Box(size=size):
            return _box(size)
        case Cylinder(radius=r, length=length):
            h = length / 2
            return _lathe([(0, -h), (r, -h)], [(r, -h), (r, h)], [(r, h), (0, h)])
        case Cone(radius=r, length=length):
            h = length / 2
            return _lathe([(0, -h), (r, -h)], [(r, -h), (0, h)])
        case Sphere(radius=r):
            return _round(r, 0.0)
        case Capsule(radius=r, length=length):
            return _round(r, length)
        case Ellipsoid(radii=radii):
            vertices, faces = _round(1.0, 0.0)
            return vertices * np.array(radii), faces
    return None


def _box(size: tuple[float, float, float]) -> tuple[Vertices, Faces]:
    vertices: list[Vertices] = []
    for axis in range(3):
        middle, u, v = (np.eye(3)[(axis + i) % 3] for i in range(3))
        vertices += [middle - u - v, middle + u - v, middle + u + v, middle - u + v]
        vertices += [-middle - v - u, -middle + v - u, -middle + v + u, -middle - v + u]
    corners = 4 * np.arange(6)[:, None]
    faces = corners + np.array([0, 1, 2, 0, 2, 3])
    return np.array(vertices) * np.array(size) / 2, faces.reshape(-1, 3).astype(np.int32)


def _round(radius: float, length: float) -> tuple[Vertices, Faces]:
    """A sphere, or a capsule whose cylinder has this length."""
    angles = np.linspace(-math.pi / 2, math.pi / 2, _UP + 1)
    if length:
        angles = np.insert(angles, _UP // 2, 0.0)
    z = radius * np.sin(angles)
    half = len(angles) / 2
    z += np.where(np.arange(len(angles)) < half, -length / 2, length / 2)
    return _lathe(np.column_stack([radius * np.cos(angles), z]).tolist())


def _lathe(*profiles: Sequence[Sequence[float]]) -> tuple[Vertices, Faces]:
    """Rotates profiles of (radius, z), which go upwards on the outside, about z."""
    angles = np.linspace(0, 2 * math.pi, _AROUND, endpoint=False)
    circle = np.column_stack([np.cos(angles), np.sin(angles), np.ones(_AROUND)])
    here = np.arange(_AROUND)
    beside = np.roll(here, -1)
    quads = np.stack(
        [here, beside, beside + _AROUND, here, beside + _AROUND, here + _AROUND], axis=1
    )
    vertices: list[Vertices] = []
    faces: list[NDArray[np.int64]] = []
    for profile in profiles:
        start = len(vertices)
        vertices += [circle * (radius, radius, z) for radius, z in profile]
        faces += [quads + ring * _AROUND for ring in range(start, len(vertices) - 1)]
    points = np.concatenate(vertices)
    triangles = np.concatenate(faces).reshape(-1, 3).astype(np.int32)
    a, b, c = (points[triangles[:, i]] for i in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    return points, triangles[area > 1e-15]
