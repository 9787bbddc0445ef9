"""Polygons of a mesh file into triangles."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

Indices = NDArray[np.int64]


def triangulate(counts: Sequence[int] | Indices, positions: NDArray[Any]) -> Indices:
    """Triangles over the corners of consecutive polygons.

    Args:
        counts: Corners of each polygon; fewer than three make no triangle.
        positions: (sum of counts, 3), the place of each corner.

    Returns:
        (m, 3) indices into the corners.
    """
    sizes = np.asarray(counts, dtype=np.int64).reshape(-1)
    if (sizes < 0).any() or int(sizes.sum()) != len(positions):
        raise ValueError(f"polygons ask for {int(sizes.sum())} corners of {len(positions)}")
    starts = np.cumsum(sizes) - sizes
    parts: list[Indices] = []
    for size in np.unique(sizes).tolist():
        if size < 3:
            continue
        begin = starts[sizes == size]
        fan = np.array([(0, i, i + 1) for i in range(1, size - 1)], dtype=np.int64)
        triangles = (begin[:, None, None] + fan).reshape(-1, 3)
        if size > 3:
            concave = _concave(positions, begin, size)
            if concave.any():
                keep = np.repeat(~concave, size - 2)
                cut = [_ear_cut(positions[b : b + size]) + b for b in begin[concave].tolist()]
                triangles = np.concatenate([triangles[keep], *cut])
        parts.append(triangles)
    return np.concatenate(parts) if parts else np.zeros((0, 3), dtype=np.int64)


def _concave(positions: NDArray[Any], begin: Indices, size: int) -> NDArray[np.bool_]:
    """Which of the polygons of equal size turn both ways."""
    points = np.asarray(positions, dtype=np.float64)[begin[:, None] + np.arange(size)]
    edges = np.roll(points, -1, axis=1) - points
    turns = np.cross(edges, np.roll(edges, -1, axis=1))
    normal = np.cross(points, np.roll(points, -1, axis=1)).sum(axis=1)
    along = np.einsum("nij,nj->ni", turns, normal)
    tolerance = 1e-9 * np.abs(along).max(axis=1, keepdims=True)
    return np.asarray((along < -tolerance).any(axis=1))


def _ear_cut(points: NDArray[Any]) -> Indices:
    """Triangles of one simple polygon, cutting off one convex corner after the other."""
    xyz = np.asarray(points, dtype=np.float64)
    normal = np.cross(xyz, np.roll(xyz, -1, axis=0)).sum(axis=0)
    drop = int(np.argmax(np.abs(normal)))
    u, v = (
        ((drop + 1) % 3, (drop + 2) % 3) if normal[drop] > 0 else ((drop + 2) % 3, (drop + 1) % 3)
    )
    flat = [(float(p[u]), float(p[v])) for p in xyz]
    left = list(range(len(flat)))
    triangles: list[tuple[int, int, int]] = []
    while len(left) > 3:
        for k in range(len(left)):
            a, b, c = left[k - 1], left[k], left[(k + 1) % len(left)]
            if _area(flat[a], flat[b], flat[c]) > 0 and not any(
                _inside(flat[p], flat[a], flat[b], flat[c]) for p in left if p not in (a, b, c)
            ):
                break
        else:
            k, a, b, c = 1, left[0], left[1], left[2]  # crosses itself: any cut is as good
        triangles.append((a, b, c))
        del left[k]
    triangles.append((left[0], left[1], left[2]))
    return np.array(triangles, dtype=np.int64)


Point = tuple[float, float]


def _area(a: Point, b: Point, c: Point) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _inside(p: Point, a: Point, b: Point, c: Point) -> bool:
    return _area(a, b, p) >= 0 and _area(b, c, p) >= 0 and _area(c, a, p) >= 0
