"""Splits polygons in mesh files into triangles."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cartwheel.geometry import cross_rows

Indices = NDArray[np.int64]


def triangulate(counts: Sequence[int] | Indices, positions: NDArray[Any]) -> Indices:
    """Triangles for consecutive polygons.

    Args:
        counts: Number of corners of each polygon; polygons with fewer than three are skipped.
        positions: Position of each corner, shape (sum of counts, 3).

    Returns:
        Corner indices, shape (m, 3).
    """
    sizes = np.asarray(counts, dtype=np.int64).reshape(-1)
    # A single size first: the sum of several could exceed the largest integer.
    if ((sizes < 0) | (sizes > len(positions))).any() or int(sizes.sum()) != len(positions):
        raise ValueError(
            f"the polygons have {int(sizes.sum())} vertices, but the index list has "
            f"{len(positions)} entries"
        )
    if (sizes == 3).all():
        return np.arange(len(positions), dtype=np.int64).reshape(-1, 3)
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
    """Which of several polygons of equal size are concave."""
    points = np.asarray(positions, dtype=np.float64)[begin[:, None] + np.arange(size)]
    edges = np.roll(points, -1, axis=1) - points
    turns = cross_rows(edges, np.roll(edges, -1, axis=1))
    normal = cross_rows(points, np.roll(points, -1, axis=1)).sum(axis=1)
    along = np.einsum("nij,nj->ni", turns, normal)
    tolerance = 1e-9 * np.abs(along).max(axis=1, keepdims=True)
    return np.asarray((along < -tolerance).any(axis=1))


def _ear_cut(points: NDArray[Any]) -> Indices:
    """Triangles of one simple concave polygon."""
    # Imported here: few meshes contain concave polygons.
    from mapbox_earcut import triangulate_float64

    xyz = np.asarray(points, dtype=np.float64)
    normal = np.cross(xyz, np.roll(xyz, -1, axis=0)).sum(axis=0)
    drop = int(np.argmax(np.abs(normal)))
    u, v = (
        ((drop + 1) % 3, (drop + 2) % 3) if normal[drop] > 0 else ((drop + 2) % 3, (drop + 1) % 3)
    )
    flat = [(float(p[u]), float(p[v])) for p in xyz]
    return np.asarray(
        triangulate_float64(np.array(flat), np.array([len(flat)], dtype=np.uint32)), dtype=np.int64
    ).reshape(-1, 3)
