"""Distances to heightmaps, which MuJoCo computes only for small ones."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np

from cartwheel.geometry import Array

_CELLS = 5
"""Cells along each side of a tile. MuJoCo compares a shape with at most 50 prisms: two per cell."""
_NEAR = 0.1
"""First limit of the distance, as a part of the shape's size. With a limit that is much larger than
the shape, MuJoCo finds no distance to the prisms that touch it."""
_FARTHER = 10.0
"""Factor of the next limit."""
_NATIVE = int(mujoco.mjtDisableBit.mjDSBL_NATIVECCD)


def distance_to_heightmap(
    model: Any, data: Any, terrain: int, other: int, *, most: float, ends: Array
) -> float:
    """Distance between a heightmap and another geom, m; `most` if it is larger.

    MuJoCo compares a shape only with the first prisms that are within the largest distance. So the
    heightmap is replaced by tiles of few cells, one after another, and put back.

    Args:
        model: The MuJoCo model.
        data: Its data.
        terrain: Index of the heightmap's geom.
        other: Index of the other geom, which is neither a heightmap nor a plane.
        most: m.
        ends: Receives the two nearest points, in the world: that of the heightmap first.
    """
    field = int(model.geom_dataid[terrain])
    rows, columns = int(model.hfield_nrow[field]), int(model.hfield_ncol[field])
    first = int(model.hfield_adr[field])
    numbers = model.hfield_data[first : first + rows * columns].copy()
    size, place = model.hfield_size[field].copy(), data.geom_xpos[terrain].copy()
    turn, flags = data.geom_xmat[terrain].reshape(3, 3), model.opt.disableflags
    heights = numbers.reshape(rows, columns)
    cell = 2 * size[:2] / (columns - 1, rows - 1)
    radius = float(model.geom_rbound[other])
    least, starts = _tiles(heights, size, cell, (data.geom_xpos[other] - place) @ turn)
    best, limit, found = most, min(most, _NEAR * radius), np.zeros(6)
    try:
        # The other method is exact only for shapes that overlap.
        model.opt.disableflags = flags & ~_NATIVE
        while True:
            for away, (row, column) in zip(least, starts, strict=True):
                if away - radius >= min(limit, best):
                    break
                tile = heights[row : row + _CELLS + 1, column : column + _CELLS + 1]
                cells = np.array([tile.shape[1] - 1, tile.shape[0] - 1])
                middle = (np.array([column, row]) + cells / 2) * cell - size[:2]
                model.hfield_nrow[field], model.hfield_ncol[field] = tile.shape
                model.hfield_data[first : first + tile.size] = tile.ravel()
                model.hfield_size[field, :2] = cells * cell / 2
                data.geom_xpos[terrain] = place + turn[:, :2] @ middle
                distance = mujoco.mj_geomDistance(model, data, terrain, other, limit, found)
                if distance < min(limit, best):
                    best = float(distance)
                    ends[:] = found
            if best < limit or limit >= most:
                return best
            limit = min(most, _FARTHER * limit)
    finally:
        model.opt.disableflags = flags
        model.hfield_nrow[field], model.hfield_ncol[field] = rows, columns
        model.hfield_data[first : first + rows * columns] = numbers
        model.hfield_size[field], data.geom_xpos[terrain] = size, place


def _tiles(
    heights: Array, size: Array, cell: Array, centre: Array
) -> tuple[list[float], list[list[int]]]:
    """Tiles by their least possible distance to a point, m, and their first rows and columns."""
    tops = np.maximum(heights[:-1, :-1], heights[:-1, 1:])
    tops = np.maximum(tops, np.maximum(heights[1:, :-1], heights[1:, 1:]))
    rows, columns = (np.arange(0, count, _CELLS) for count in tops.shape)
    tops = np.maximum.reduceat(np.maximum.reduceat(tops, rows, axis=0), columns, axis=1)
    starts = np.stack(np.meshgrid(rows, columns, indexing="ij"), axis=-1).reshape(-1, 2)
    low = starts[:, ::-1] * cell - size[:2]
    high = np.minimum(low + _CELLS * cell, size[:2])
    low = np.column_stack([low, np.full(len(low), -size[3])])
    high = np.column_stack([high, tops.ravel() * size[2]])
    away = np.maximum(np.maximum(low - centre, centre - high), 0.0)
    least = np.linalg.norm(away, axis=1)
    order = np.argsort(least, kind="stable")
    return least[order].tolist(), starts[order].tolist()
