"""Flat outlines with holes, as convex pieces and as a solid: SDF's ``<polyline>``.

What an odd number of the outlines surrounds is filled, so an outline within another is a hole.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from cartwheel.description.model import Polyline

Point = tuple[float, float]
Loop = tuple[Point, ...]
Edge = tuple[Point, Point]
_SAME = 1e-9
"""m, below which two heights of the plane are one."""


def convex_pieces(shape: Polyline) -> tuple[Loop, ...]:
    """Convex polygons, counter-clockwise, that together fill the outlines and do not overlap."""
    return _pieces(_loops(shape))


def solid(shape: Polyline) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
    """The outlines pulled up from z = 0 to the height.

    Returns:
        Vertices (n, 3) in m and faces (m, 3), counter-clockwise from outside; faces of the top,
        the bottom and each side share no vertex.
    """
    loops = _loops(shape)
    vertices: list[tuple[float, float, float]] = []
    faces: list[tuple[int, int, int]] = []
    for piece in _pieces(loops):
        for z, order in ((0.0, -1), (shape.height, 1)):
            start = len(vertices)
            vertices += [(x, y, z) for x, y in piece[::order]]
            faces += [(start, start + i, start + i + 1) for i in range(1, len(piece) - 1)]
    size = max(np.ptp(np.array([point for loop in loops for point in loop]), axis=0))
    edges = _edges(loops)
    for edge in edges:
        for a, b in itertools.pairwise(_split(edge, edges)):
            along = np.subtract(b, a)
            across = np.array([-along[1], along[0]]) / np.linalg.norm(along)
            left, right = (np.add(a, b) / 2 + side * 1e-6 * size * across for side in (1, -1))
            filled = _inside(loops, left), _inside(loops, right)
            if filled[0] == filled[1]:
                continue  # an edge within the solid or outside of it
            first, second = (a, b) if filled[0] else (b, a)
            start = len(vertices)
            vertices += [(*first, 0.0), (*second, 0.0), (*second, shape.height)]
            vertices.append((*first, shape.height))
            faces += [(start, start + 1, start + 2), (start, start + 2, start + 3)]
    return np.array(vertices, dtype=np.float32), np.array(faces, dtype=np.int32)


def _loops(shape: Polyline) -> tuple[Loop, ...]:
    """All outlines, without points that repeat their neighbour."""
    loops = []
    for outline in (shape.points, *shape.holes):
        points = [p for i, p in enumerate(outline) if p != outline[i - 1]]
        if len(points) >= 3:
            loops.append(tuple(points))
    return tuple(loops)


@lru_cache(maxsize=64)
def _pieces(loops: tuple[Loop, ...]) -> tuple[Loop, ...]:
    return tuple(fill(_edges(loops)))


def fill(edges: Sequence[Edge]) -> list[Loop]:
    """Convex polygons, counter-clockwise, that fill what an odd number of closed outlines holds.

    Args:
        edges: Of the outlines, in any order and direction.
    """
    # Cut into strips at the y of every corner and crossing: in a strip all is trapezoids.
    slanting = _slanting(edges)
    levels = _levels(tuple(edges))
    open_pieces: dict[tuple[Edge, Edge], tuple[float, float]] = {}
    done: list[Loop] = []
    for low, high in itertools.pairwise(levels):
        if high - low <= _SAME:
            continue
        middle = (low + high) / 2
        crossed = sorted(
            (e for e in slanting if e[0][1] < middle < e[1][1]), key=lambda e: _x_at(e, middle)
        )
        strip = dict.fromkeys(zip(crossed[::2], crossed[1::2], strict=False))
        ended = [pair for pair in open_pieces if pair not in strip]
        done += [_trapezoid(pair, *open_pieces.pop(pair)) for pair in ended]
        for pair in strip:
            # Between the same two edges it is the same trapezoid, one strip higher.
            open_pieces[pair] = (open_pieces.get(pair, (low, high))[0], high)
    done += [_trapezoid(pair, *span) for pair, span in open_pieces.items()]
    return [piece for piece in done if len(piece) >= 3]


def _edges(loops: Sequence[Loop]) -> list[Edge]:
    return [edge for loop in loops for edge in zip(loop, loop[1:] + loop[:1], strict=True)]


def _slanting(edges: Sequence[Edge]) -> list[Edge]:
    """The edges that are not level, from their lower to their upper end."""
    return [(a, b) if a[1] < b[1] else (b, a) for a, b in edges if abs(a[1] - b[1]) > _SAME]


@lru_cache(maxsize=64)
def _levels(edges: tuple[Edge, ...]) -> tuple[float, ...]:
    """The y of all corners and crossings, rising."""
    corners = {y for edge in edges for _, y in edge}
    return tuple(sorted(corners | set(_crossings(_slanting(edges)))))


def _split(edge: Edge, edges: Sequence[Edge]) -> list[Point]:
    """The ends of an edge, and between them where the side that is filled may change."""
    a, b = edge
    if abs(a[1] - b[1]) > _SAME:
        low, high = sorted((a[1], b[1]))
        between = [
            (_x_at(edge, y), y) for y in _levels(tuple(edges)) if low + _SAME < y < high - _SAME
        ]
    else:
        touching = [e for e in _slanting(edges) if e[0][1] - _SAME <= a[1] <= e[1][1] + _SAME]
        low, high = sorted((a[0], b[0]))
        found = {_x_at(e, a[1]) for e in touching}
        between = [(x, a[1]) for x in sorted(found) if low + _SAME < x < high - _SAME]
    return sorted([a, *between, b], key=lambda p: (p[0] - a[0]) ** 2 + (p[1] - a[1]) ** 2)


def _trapezoid(pair: tuple[Edge, Edge], low: float, high: float) -> Loop:
    left, right = pair
    corners = [
        (_x_at(left, low), low),
        (_x_at(right, low), low),
        (_x_at(right, high), high),
        (_x_at(left, high), high),
    ]
    return tuple(
        c for i, c in enumerate(corners) if abs(c[0] - corners[i - 1][0]) > _SAME
        or abs(c[1] - corners[i - 1][1]) > _SAME
    )  # fmt: skip


def _x_at(edge: Edge, y: float) -> float:
    (x0, y0), (x1, y1) = edge
    return x0 + (x1 - x0) * (y - y0) / (y1 - y0)


def _crossings(edges: Sequence[Edge]) -> list[float]:
    """The y at which two edges cross between their ends."""
    found = []
    for i, (a, b) in enumerate(edges):
        for c, d in edges[i + 1 :]:
            r, s = (b[0] - a[0], b[1] - a[1]), (d[0] - c[0], d[1] - c[1])
            area = r[0] * s[1] - r[1] * s[0]
            if abs(area) < 1e-12:
                continue
            t = ((c[0] - a[0]) * s[1] - (c[1] - a[1]) * s[0]) / area
            u = ((c[0] - a[0]) * r[1] - (c[1] - a[1]) * r[0]) / area
            if _SAME < t < 1 - _SAME and _SAME < u < 1 - _SAME:
                found.append(a[1] + t * r[1])
    return found


def _inside(loops: Sequence[Loop], point: NDArray[np.float64]) -> bool:
    """Whether an odd number of edges lies to the right of a point."""
    x, y = float(point[0]), float(point[1])
    count = 0
    for loop in loops:
        for a, b in zip(loop, loop[1:] + loop[:1], strict=True):
            if (a[1] > y) != (b[1] > y) and _x_at((a, b), y) > x:
                count += 1
    return count % 2 == 1
