"""Texture coordinates of simple shapes, as in Gazebo.

MuJoCo's texture coordinates differ: images are upside down on a box and mirrored on a plane.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from cartwheel.description.model import Box, Cylinder, Plane, Shape, Sphere
from cartwheel.geometry import Array

_AROUND = 64
"""Segments in a circle: the maximum deviation is 0.0012 radii."""
_BOX = (
    # The image corners of each side, clockwise from the upper left: signs of x, y, z.
    ((-1, -1, 1), (1, -1, 1), (1, -1, -1), (-1, -1, -1)),
    ((1, 1, 1), (-1, 1, 1), (-1, 1, -1), (1, 1, -1)),
    ((-1, 1, 1), (-1, -1, 1), (-1, -1, -1), (-1, 1, -1)),
    ((1, -1, 1), (1, 1, 1), (1, 1, -1), (1, -1, -1)),
    ((1, 1, 1), (1, -1, 1), (-1, -1, 1), (-1, 1, 1)),
    ((-1, 1, -1), (-1, -1, -1), (1, -1, -1), (1, 1, -1)),
)
"""Upright on the sides; the upper edge is in front on the top face, and behind on the bottom face.
Source: Gazebo 11's ``MeshManager``, as for the other shapes.
"""
_SQUARE = ((0.0, 1.0), (1.0, 1.0), (1.0, 0.0), (0.0, 0.0))


@dataclass(frozen=True, slots=True, eq=False)
class Wrapped:
    """A surface with texture coordinates."""

    vertices: Array
    """m, shape (n, 3)."""
    faces: Any
    """Shape (m, 3), counter-clockwise from outside."""
    uv: Array
    """Texture coordinates from the image's lower left corner, shape (n, 2)."""


def wrapped(shape: Shape) -> Wrapped | None:
    """The textured surface of a shape; None for shapes without texture coordinates in Gazebo."""
    match shape:
        case Box(size=size):
            return _quads(np.array(_BOX) * np.array(size) / 2)
        case Plane(size=(x, y)):
            corners = np.array([[(-x, y, 0), (x, y, 0), (x, -y, 0), (-x, -y, 0)]]) / 2
            return _quads(corners)
        case Sphere(radius=radius):
            return _sphere(radius)
        case Cylinder(radius=radius, length=length):
            return _cylinder(radius, length)
    return None


def scaled(uv: Any, scale: tuple[float, float]) -> Array:
    """Coordinates of an image that covers part of the surface and is repeated."""
    found: Array = (np.asarray(uv) - 0.5) / scale + 0.5
    return found


def _quads(corners: Array) -> Wrapped:
    """Quads with a whole image each; shape (n, 4, 3), clockwise from the upper left corner."""
    count = len(corners)
    triangles = np.array([(0, 2, 1), (0, 3, 2)])
    faces = (np.arange(count)[:, None, None] * 4 + triangles).reshape(-1, 3)
    return Wrapped(corners.reshape(-1, 3), faces, np.tile(np.array(_SQUARE), (count, 1)))


def _sphere(radius: float) -> Wrapped:
    """A sphere with its poles along y; the image's edges meet on top."""
    rows = _AROUND // 2
    down, around = np.meshgrid(
        np.linspace(0, math.pi, rows + 1), np.linspace(0, 2 * math.pi, _AROUND + 1), indexing="ij"
    )
    wide = np.sin(down)
    vertices = radius * np.stack(
        [wide * np.sin(around), np.cos(down), wide * np.cos(around)], axis=-1
    )
    uv = np.stack([around / (2 * math.pi), 1 - down / math.pi], axis=-1)
    return Wrapped(vertices.reshape(-1, 3), _grid(rows, _AROUND), uv.reshape(-1, 2))


def _cylinder(radius: float, length: float) -> Wrapped:
    """A cylinder with the image upside down and its edges at the left; caps repeat the image's
    edge.
    """
    turn = np.linspace(0, 2 * math.pi, _AROUND + 1)
    part = turn / (2 * math.pi)
    x, y = radius * np.sin(turn), radius * np.cos(turn)
    top, bottom = np.full_like(x, length / 2), np.full_like(x, -length / 2)
    rims = [np.stack([x, y, z], axis=-1) for z in (bottom, top, top, bottom)]
    heights = [1.0, 0.0, 0.0, 1.0]
    middles = np.array([[0, 0, length / 2], [0, 0, -length / 2]])
    vertices = np.concatenate([*rims, middles])
    uv = np.concatenate(
        [np.stack([part, np.full_like(part, height)], axis=-1) for height in heights]
        + [np.array([[0.0, 1.0], [0.0, 1.0]])]
    )
    count = _AROUND + 1
    here = np.arange(_AROUND)
    above = np.stack([np.full(_AROUND, 4 * count), 2 * count + here + 1, 2 * count + here], axis=1)
    below = np.stack([np.full(_AROUND, 4 * count + 1), 3 * count + here, 3 * count + here + 1], 1)
    return Wrapped(vertices, np.concatenate([_grid(1, _AROUND), above, below]), uv)


def _grid(rows: int, columns: int) -> Any:
    """Triangles between rows of ``columns + 1`` vertices, seen with the first row above."""
    row, column = np.meshgrid(np.arange(rows), np.arange(columns), indexing="ij")
    first = (row * (columns + 1) + column).ravel()
    below = first + columns + 1
    return np.concatenate(
        [
            np.stack([first, below, first + 1], axis=1),
            np.stack([first + 1, below, below + 1], axis=1),
        ]
    )
