"""Rays of sensors into a MuJoCo model, by Embree."""

from __future__ import annotations

from typing import Any

import numpy as np

from cartwheel.codes.world import EMBREE_MISSING
from cartwheel.errors import Diagnostic
from cartwheel.geometry import Array
from cartwheel.simulation.sensing.ray_query import Band, Hits, Query
from cartwheel.simulation.sensing.ray_scenes import RayScenes
from cartwheel.simulation.sensing.ray_triangles import AVAILABLE

_CHUNK = 32768
"""Maximum number of rays that are cast at a time."""


class SharedRayScenes:
    """The shapes of the current models, which all sensors of a simulation share."""

    def __init__(self) -> None:
        self._scenes: dict[int, RayScenes] = {}
        self.moved: frozenset[int] = frozenset()
        """Bodies that are fixed to the world and move at a velocity."""
        self._reported = AVAILABLE

    def of(self, model: Any, data: Any, group: int) -> RayScenes:
        """The shapes of a group of geoms."""
        found = self._scenes.get(group)
        if found is None or found.model is not model or found.data is not data:
            found = self._scenes[group] = RayScenes(model, data, group, lambda: self.moved)
        return found

    def missing(self) -> Diagnostic | None:
        """The diagnostic that Embree is missing, at the first call."""
        if self._reported:
            return None
        self._reported = True
        return EMBREE_MISSING.diagnostic(
            "MuJoCo computes the rays of lidars, which takes longer in large worlds",
            hint="Install the package embreex, which exists for x86-64 processors.",
        )


class EmbreeCaster:
    """The rays of one sensor.

    Args:
        shared: The shapes.
        model: The MuJoCo model.
        data: Its data.
        group: Geoms of this group are hit.
        body: The sensor's body.
        own: Whether each geom belongs to the sensor's model.
        offset: Where the rays start in the body, m.
        directions: Unit vectors in the axes of the body, shape (n, 3).
        minimum: Geoms of the sensor's model that a ray hits nearer than this are left out for it.
        maximum: Maximum distance, m.
    """

    def __init__(
        self, shared: SharedRayScenes, model: Any, data: Any, *, group: int, body: int, own: Any,
        offset: Array, directions: Array, minimum: float, maximum: float,
    ) -> None:  # fmt: skip
        self._scenes = shared.of(model, data, group)
        self._body, self._own = body, own
        self._offset, self._directions = offset, directions
        self._minimum, self._maximum = minimum, maximum
        self._band = Band.of(directions)
        self._with: tuple[int, bool, Hits] | None = None

    def cast(self, start: Array, turn: Array, hidden: frozenset[int]) -> tuple[Array, Any]:
        """Casts the rays.

        Args:
            start: Where they start, m.
            turn: Rotation matrix of the sensor's body.
            hidden: Geoms that are not hit.

        Returns:
            Distances in m, shape (n,), inf without a hit; and the index of each geom, or -1.
        """
        self._scenes.refresh()
        count = len(self._directions)
        with np.errstate(divide="ignore", invalid="ignore"):
            if count <= _CHUNK:
                hits = self._cast(start, turn, hidden, slice(None))
                return hits.distances, hits.geoms
            distances, geoms = np.empty(count), np.empty(count, dtype=np.int32)
            # Intermediate results of all rays would need several times their memory.
            for first in range(0, count, _CHUNK):
                part = slice(first, first + _CHUNK)
                hits = self._cast(start, turn, hidden, part)
                distances[part], geoms[part] = hits.distances, hits.geoms
        return distances, geoms

    def _cast(self, start: Array, turn: Array, hidden: frozenset[int], part: slice) -> Hits:
        scenes = self._scenes
        query = Query(
            start, self._directions[part] @ turn.T, self._own, self._minimum, self._maximum,
            hidden, self._band, turn,
        )  # fmt: skip
        hits = scenes.cast_fixed(query)
        root = scenes.root_of(self._body)
        if root:
            some, with_sensor = self._cast_with(root, hidden)
            if some:
                hits.add(with_sensor.distances[part], with_sensor.geoms[part])
        scenes.cast_planes(query, hits)
        scenes.cast_moving(query, hits, without=root)
        return hits

    def _cast_with(self, root: int, hidden: frozenset[int]) -> tuple[bool, Hits]:
        """The hits of what moves with the sensor, which are always the same.

        Returns:
            Whether there are any, and the hits of all rays.
        """
        scenes = self._scenes
        if self._with is None or self._with[0] != scenes.version:
            place, turn = scenes.place_of(self._body)
            start, rays = place + turn @ self._offset, self._directions @ turn.T
            query = Query(start, rays, self._own, self._minimum, hidden=hidden)
            found = scenes.cast_with(root, query)
            self._with = scenes.version, bool(np.isfinite(found.distances).any()), found
        return self._with[1:]
