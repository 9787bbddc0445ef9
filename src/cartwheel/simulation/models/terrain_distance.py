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


class Terrain:
    """A heightmap of a compiled model, to which distances are computed.

    MuJoCo compares a shape only with the first prisms that are within the largest distance. So the
    heightmap is replaced by tiles of few cells, one after another, and put back.

    Args:
        model: The MuJoCo model.
        geom: Index of the heightmap's geom.
    """

    def __init__(self, model: Any, geom: int) -> None:
        self._model, self._geom = model, geom
        field = self._field = int(model.geom_dataid[geom])
        rows, columns = int(model.hfield_nrow[field]), int(model.hfield_ncol[field])
        first = self._first = int(model.hfield_adr[field])
        numbers = model.hfield_data[first : first + rows * columns]
        heights = self._heights = numbers.copy().reshape(rows, columns)
        size = self._size = model.hfield_size[field].copy()
        cell = self._cell = 2 * size[:2] / (columns - 1, rows - 1)
        tops = np.maximum(heights[:-1, :-1], heights[:-1, 1:])
        tops = np.maximum(tops, np.maximum(heights[1:, :-1], heights[1:, 1:]))
        starts = [np.arange(0, count, _CELLS) for count in tops.shape]
        tops = np.maximum.reduceat(np.maximum.reduceat(tops, starts[0], axis=0), starts[1], axis=1)
        self._starts = np.stack(np.meshgrid(*starts, indexing="ij"), axis=-1).reshape(-1, 2)
        """First row and column of each tile."""
        low = self._starts[:, ::-1] * cell - size[:2]
        high = np.minimum(low + _CELLS * cell, size[:2])
        self._low = np.column_stack([low, np.full(len(low), -size[3])])
        """Corners of the boxes around the tiles, m, in the frame of the heightmap."""
        self._high = np.column_stack([high, tops.ravel() * size[2]])

    def distance(self, data: Any, other: int, *, most: float, ends: Array) -> float:
        """Distance to another geom, m; `most` if it is larger.

        Args:
            data: The data of the model.
            other: Index of the other geom, which is neither a heightmap nor a plane.
            most: m.
            ends: Receives the two nearest points, in the world: that of the heightmap first.
        """
        model, field, terrain = self._model, self._field, self._geom
        rows, columns = self._heights.shape
        size, place = self._size, data.geom_xpos[terrain].copy()
        turn, flags = data.geom_xmat[terrain].reshape(3, 3), model.opt.disableflags
        first = self._first
        radius = float(model.geom_rbound[other])
        least = self._least((data.geom_xpos[other] - place) @ turn) - radius
        best, limit, found = most, min(most, _NEAR * radius), np.zeros(6)
        try:
            # The other method is exact only for shapes that overlap.
            model.opt.disableflags = flags & ~_NATIVE
            while True:
                within = np.flatnonzero(least < limit)
                for index in within[np.argsort(least[within], kind="stable")].tolist():
                    if least[index] >= min(limit, best):
                        break
                    row, column = self._starts[index].tolist()
                    tile = self._heights[row : row + _CELLS + 1, column : column + _CELLS + 1]
                    cells = np.array([tile.shape[1] - 1, tile.shape[0] - 1])
                    middle = (np.array([column, row]) + cells / 2) * self._cell - size[:2]
                    model.hfield_nrow[field], model.hfield_ncol[field] = tile.shape
                    model.hfield_data[first : first + tile.size] = tile.ravel()
                    model.hfield_size[field, :2] = cells * self._cell / 2
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
            changed = self._heights.ravel()[: (_CELLS + 1) ** 2]
            model.hfield_data[first : first + changed.size] = changed
            model.hfield_size[field], data.geom_xpos[terrain] = size, place

    def _least(self, centre: Array) -> Array:
        """The least possible distance of each tile to a point in the frame of the heightmap, m."""
        away = np.maximum(np.maximum(self._low - centre, centre - self._high), 0.0)
        least: Array = np.linalg.norm(away, axis=1)
        return least
