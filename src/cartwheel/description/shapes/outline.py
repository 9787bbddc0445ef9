"""Converts flat outlines with holes to convex pieces or a solid, for SDF's ``<polyline>``.

Points inside an odd number of outlines are filled, so an outline within another is a hole.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from cartwheel.description.model import Polyline
from cartwheel.errors import Pickled

Point = tuple[float, float]
Loop = tuple[Point, ...]
Edge = tuple[Point, Point]
MOST_EDGES, MOST_CROSSINGS, MOST_PIECES = 2000, 1000, 6000
"""Maximum for all outlines of a shape; such a shape takes two seconds, and four to build."""
_SAME = 1e-9
"""m; two y values that differ by less are equal."""


class OutlineError(Pickled, ValueError):
    """Outlines that would take too long to fill.

    Args:
        kind: What there is too much of: ``points``, ``crossings`` or ``pieces``.
        most: The limit.
    """

    def __init__(self, message: str, kind: str, most: int) -> None:
        super().__init__(message)
        self.kind = kind
        self.most = most


def convex_pieces(shape: Polyline) -> tuple[Loop, ...]:
    """Non-overlapping convex polygons, counter-clockwise, that fill the outlines.

    Raises:
        OutlineError: There are too many points or crossings.
    """
    return _pieces(_loops(shape))


def solid(shape: Polyline) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
    """Extrudes the outlines from z = 0 to the height.

    Returns:
        Vertices (n, 3) in m and faces (m, 3), counter-clockwise from outside. The top, the bottom
        and each side share no vertices.
    """
    loops = _loops(shape)
    vertices: list[tuple[float, float, float]] = []
    faces: list[tuple[int, int, int]] = []
    for piece in _pieces(loops):
        for z, order in ((0.0, -1), (shape.height, 1)):
            start = len(vertices)
            vertices += [(x, y, z) for x, y in piece[::order]]
            faces += [(start, start + i, start + i + 1) for i in range(1, len(piece) - 1)]
    edges = _edges(loops)
    parts = [part for edge in _split(edges) for part in itertools.pairwise(edge)]
    starts, ends = np.array(parts, dtype=float).transpose(1, 0, 2)
    along = ends - starts
    size = np.ptp(np.array(edges).reshape(-1, 2), axis=0).max()
    across = np.column_stack([-along[:, 1], along[:, 0]])
    # hypot, because the squares of tiny lengths underflow.
    across /= np.hypot(along[:, :1], along[:, 1:])
    across *= 1e-6 * size
    middles = (starts + ends) / 2
    left, right = _inside(edges, middles + across), _inside(edges, middles - across)
    for (a, b), on_left, on_right in zip(parts, left.tolist(), right.tolist(), strict=True):
        if on_left == on_right:
            continue  # an edge inside or outside the solid
        first, second = (a, b) if on_left else (b, a)
        start = len(vertices)
        vertices += [(*first, 0.0), (*second, 0.0), (*second, shape.height)]
        vertices.append((*first, shape.height))
        faces += [(start, start + 1, start + 2), (start, start + 2, start + 3)]
    return np.array(vertices, dtype=np.float32), np.array(faces, dtype=np.int32)


def _loops(shape: Polyline) -> tuple[Loop, ...]:
    """All outlines without repeated points."""
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
    """Convex polygons, counter-clockwise, that fill the area inside an odd number of outlines.

    Args:
        edges: Edges of the outlines, in any order and direction.

    Raises:
        OutlineError: There are too many edges or crossings.
    """
    # Cut into strips at the y of every corner and crossing, so that each strip contains only
    # trapezoids.
    slanting = _slanting(edges)
    if len(edges) > MOST_EDGES:
        message = f"the <polyline> has {len(edges)} points; the limit is {MOST_EDGES}"
        raise OutlineError(message, "points", MOST_EDGES)
    levels = _levels(edges)
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
            # Between the same two edges, the trapezoid of the lower strip is extended.
            open_pieces[pair] = (open_pieces.get(pair, (low, high))[0], high)
        if len(done) > MOST_PIECES:
            message = f"the <polyline> consists of more than {MOST_PIECES} convex pieces"
            raise OutlineError(message, "pieces", MOST_PIECES)
    done += [_trapezoid(pair, *span) for pair, span in open_pieces.items()]
    return [piece for piece in done if len(piece) >= 3]


def _edges(loops: Sequence[Loop]) -> list[Edge]:
    return [edge for loop in loops for edge in zip(loop, loop[1:] + loop[:1], strict=True)]


def _slanting(edges: Sequence[Edge]) -> list[Edge]:
    """The edges that are not level, from the lower to the upper end."""
    return [(a, b) if a[1] < b[1] else (b, a) for a, b in edges if abs(a[1] - b[1]) > _SAME]


def _levels(edges: Sequence[Edge]) -> list[float]:
    """The y values of all corners and crossings, in ascending order."""
    found = {y for edge in edges for _, y in edge}
    slanting = _slanting(edges)
    count = 0
    for i, t, u in _meetings(slanting):
        within = (t > _SAME) & (t < 1 - _SAME) & (u > _SAME) & (u < 1 - _SAME)
        count += int(within.sum())
        if count > 2 * MOST_CROSSINGS:  # each crossing is found from both edges
            message = f"the <polyline> crosses itself more than {MOST_CROSSINGS} times"
            raise OutlineError(message, "crossings", MOST_CROSSINGS)
        (_, y0), (_, y1) = slanting[i]
        found.update((y0 + t[within] * (y1 - y0)).tolist())
    return sorted(found)


def _split(edges: Sequence[Edge]) -> list[list[Point]]:
    """The ends of each edge and all intersections, where the filled side may change."""
    corners = np.array([edge[0] for edge in edges])
    found = []
    for i, t, u in _meetings(edges):
        a, b = np.array(edges[i])
        along = b - a
        # Corners on the edge too, because parallel edges have no other intersection.
        offsets = corners - a
        length = np.linalg.norm(along)
        beside = np.abs(offsets[:, 0] * along[1] - offsets[:, 1] * along[0]) < _SAME * length
        places = np.concatenate([t[(u > -_SAME) & (u < 1 + _SAME)], offsets[beside] @ along])
        places[-int(beside.sum()) or len(places) :] /= length**2
        inner = np.unique(np.round(places[(places > _SAME) & (places < 1 - _SAME)], 12))
        found.append([edges[i][0], *map(tuple, (a + inner[:, None] * along).tolist()), edges[i][1]])
    return found


def _meetings(
    edges: Sequence[Edge],
) -> Iterator[tuple[int, NDArray[np.float64], NDArray[np.float64]]]:
    """For each edge, its intersections with the lines of the others, as fractions of both."""
    ends = np.array(edges).reshape(-1, 2, 2)
    starts, along = ends[:, 0], ends[:, 1] - ends[:, 0]
    for i, (start, r) in enumerate(zip(starts, along, strict=True)):
        area = r[0] * along[:, 1] - r[1] * along[:, 0]
        real = np.abs(area) >= 1e-12
        apart, s = starts[real] - start, along[real]
        t = (apart[:, 0] * s[:, 1] - apart[:, 1] * s[:, 0]) / area[real]
        u = (apart[:, 0] * r[1] - apart[:, 1] * r[0]) / area[real]
        yield i, t, u


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


def _inside(edges: Sequence[Edge], points: NDArray[np.float64]) -> NDArray[np.bool_]:
    """For each point, whether an odd number of edges lies to its right."""
    ends = np.array(edges)
    (x0, y0), (x1, y1) = ends[:, 0].T, ends[:, 1].T
    found = np.zeros(len(points), dtype=bool)
    with np.errstate(divide="ignore", invalid="ignore"):
        slope = (x1 - x0) / (y1 - y0)
    for first in range(0, len(points), 256):
        x, y = points[first : first + 256].T[:, :, None]
        passed = (y0 > y) != (y1 > y)
        with np.errstate(invalid="ignore"):
            right = x0 + (y - y0) * slope > x
        found[first : first + 256] = (passed & right).sum(axis=1) % 2 == 1
    return found
