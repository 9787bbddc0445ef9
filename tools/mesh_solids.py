"""Closed triangle solids from dimensions: the parts of the cart's and the models' meshes.

Units are metres, z is up.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np


@dataclass
class Solid:
    """Triangles: `vertices` (n, 3) in metres, `faces` (m, 3) counter-clockwise from outside."""

    vertices: np.ndarray
    faces: np.ndarray

    def moved(self, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Solid:
        return Solid(self.vertices + np.array([x, y, z]), self.faces)

    def turned(self, axis: str, angle: float) -> Solid:
        """Rotated about a coordinate axis by an angle in radians."""
        c, s = math.cos(angle), math.sin(angle)
        i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
        rotation = np.eye(3)
        rotation[i, i], rotation[i, j], rotation[j, i], rotation[j, j] = c, -s, s, c
        return Solid(self.vertices @ rotation.T, self.faces)

    def scaled(self, factor: float) -> Solid:
        return Solid(self.vertices * factor, self.faces)


def joined(solids: Iterable[Solid]) -> Solid:
    vertices, faces, offset = [], [], 0
    for solid in solids:
        vertices.append(solid.vertices)
        faces.append(solid.faces + offset)
        offset += len(solid.vertices)
    return Solid(np.concatenate(vertices), np.concatenate(faces))


# Shapes


def loft(rings: Sequence[np.ndarray], cap: bool = True) -> Solid:
    """A skin over rings of equally many points, each seen counter-clockwise from the last one's
    side; `cap` closes both ends, whose rings must be convex.
    """
    n = len(rings[0])
    faces = []
    for k in range(len(rings) - 1):
        for i in range(n):
            a, b = k * n + i, k * n + (i + 1) % n
            faces += [(a, b, b + n), (a, b + n, a + n)]
    if cap:
        last = (len(rings) - 1) * n
        for i in range(1, n - 1):
            faces += [(0, i + 1, i), (last, last + i, last + i + 1)]
    return Solid(np.concatenate(rings), np.array(faces))


def rounded_rectangle(x: float, y: float, radius: float, segments: int) -> np.ndarray:
    """Outline points (n, 2), counter-clockwise, of a rectangle x by y with round corners."""
    points = []
    for corner, (sx, sy) in enumerate([(1, 1), (-1, 1), (-1, -1), (1, -1)]):
        for k in range(segments + 1):
            angle = math.pi / 2 * (corner + k / segments)
            points.append(
                (
                    sx * (x / 2 - radius) + radius * math.cos(angle),
                    sy * (y / 2 - radius) + radius * math.sin(angle),
                )
            )
    return np.array(points)


def slab(
    x: float, y: float, z: float, radius: float, bevel: float, *, segments: int = 4, foot: float = 0
) -> Solid:
    """A plate with round corners and bevelled edges, centred; `foot` draws its lower rim in."""
    rings = []
    for height, inset in (
        (-z / 2, bevel + foot),
        (-z / 2 + bevel, foot),
        (z / 2 - bevel, 0.0),
        (z / 2, bevel),
    ):
        outline = rounded_rectangle(
            x - 2 * inset, y - 2 * inset, max(radius - inset, 0.002), segments
        )
        rings.append(np.column_stack([outline, np.full(len(outline), height)]))
    return loft(rings)


def box(x: float, y: float, z: float) -> Solid:
    """A sharp box, centred."""
    outline = np.array([(x, y), (-x, y), (-x, -y), (x, -y)]) / 2
    return loft([np.column_stack([outline, np.full(4, h)]) for h in (-z / 2, z / 2)])


def bar(x: float, y: float, z: float, bevel: float) -> Solid:
    """A box with its edges along x bevelled, centred: a board, seen from its ends."""
    b = bevel
    outline = [
        (y / 2, z / 2 - b), (y / 2 - b, z / 2), (-y / 2 + b, z / 2), (-y / 2, z / 2 - b),
        (-y / 2, -z / 2 + b), (-y / 2 + b, -z / 2), (y / 2 - b, -z / 2), (y / 2, -z / 2 + b),
    ]  # fmt: skip
    return loft([np.array([(end, py, pz) for py, pz in outline]) for end in (-x / 2, x / 2)])


def lathe(profile: Sequence[tuple[float, float]], segments: int, closed: bool = False) -> Solid:
    """A profile of (radius, height) points, from the bottom up, turned about z; a profile that is
    closed makes a ring; points on the axis make a pole.
    """
    points = [*profile, profile[0]] if closed else list(profile)
    angles = 2 * math.pi * np.arange(segments) / segments
    circle = np.column_stack([np.cos(angles), np.sin(angles)])
    vertices: list[np.ndarray] = []
    rows = []
    count = 0
    for radius, height in points:
        if radius == 0.0:
            vertices.append(np.array([[0.0, 0.0, height]]))
            rows.append([count] * segments)
            count += 1
        else:
            vertices.append(np.column_stack([circle * radius, np.full(segments, height)]))
            rows.append(list(range(count, count + segments)))
            count += segments
    faces = []
    for low, high in pairwise(rows):
        for i in range(segments):
            j = (i + 1) % segments
            if low[i] != low[j]:
                faces.append((low[i], low[j], high[j]))
            if high[i] != high[j]:
                faces.append((low[i], high[j], high[i]))
    return Solid(np.concatenate(vertices), np.array(faces))


def rod(radius: float, length: float, segments: int, bevel: float = 0.0) -> Solid:
    """A cylinder along z, centred, with bevelled ends."""
    h = length / 2
    if bevel:
        profile = [(0.0, -h), (radius - bevel, -h), (radius, -h + bevel)]
        profile += [(radius, h - bevel), (radius - bevel, h), (0.0, h)]
    else:
        profile = [(0.0, -h), (radius, -h), (radius, h), (0.0, h)]
    return lathe(profile, segments)


def tube(path: Sequence[tuple[float, float, float]], radius: float, segments: int) -> Solid:
    """A round bar swept along a plane path, mitred at its bends."""
    points = np.array(path, dtype=float)
    directions = np.diff(points, axis=0)
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    normal = np.cross(directions[0], directions[-1])
    if np.linalg.norm(normal) < 1e-9:
        normal = np.cross(directions[0], [0.0, 0.0, 1.0])
        if np.linalg.norm(normal) < 1e-9:
            normal = np.array([1.0, 0.0, 0.0])
    normal /= np.linalg.norm(normal)
    angles = 2 * math.pi * np.arange(segments) / segments
    rings = []
    for k, point in enumerate(points):
        before = directions[max(k - 1, 0)]
        after = directions[min(k, len(directions) - 1)]
        tangent = (before + after) / np.linalg.norm(before + after)
        across = np.cross(tangent, normal)
        widen = 1 / max(float(np.dot(tangent, after)), 0.5)
        rings.append(
            point
            + radius * np.outer(np.cos(angles), normal)
            + radius * widen * np.outer(np.sin(angles), across)
        )
    return outward(loft(rings))


def outward(solid: Solid) -> Solid:
    """The closed solid with its faces oriented outwards."""
    a, b, c = (solid.vertices[solid.faces[:, k]] for k in range(3))
    volume = np.einsum("ij,ij->", a, np.cross(b, c))
    return solid if volume > 0 else Solid(solid.vertices, solid.faces[:, ::-1])


def bend(
    start: tuple[float, float], corner: tuple[float, float], end: tuple[float, float],
    radius: float, segments: int,
) -> list[tuple[float, float]]:  # fmt: skip
    """Points of the arc that rounds a right-angled corner between two straight runs."""
    corner_, start_, end_ = np.array(corner), np.array(start), np.array(end)
    to_start = (start_ - corner_) / np.linalg.norm(start_ - corner_)
    to_end = (end_ - corner_) / np.linalg.norm(end_ - corner_)
    centre = corner_ + radius * (to_start + to_end)
    points = []
    for k in range(segments + 1):
        angle = math.pi / 2 * k / segments
        point = centre - radius * (to_end * math.cos(angle) + to_start * math.sin(angle))
        points.append((float(point[0]), float(point[1])))
    return points
