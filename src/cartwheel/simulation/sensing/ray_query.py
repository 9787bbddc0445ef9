"""Rays that start at one point, and what they hit."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from cartwheel.geometry import Array

_SLACK = 1e-6
"""rad."""


@dataclass(slots=True)
class Hits:
    """The nearest hit of each ray. All arrays have shape (n,)."""

    distances: Array
    """m; inf without a hit."""
    geoms: Any
    """Index of the geom, or -1."""

    @classmethod
    def none(cls, count: int) -> Hits:
        """No hits of some rays."""
        return cls(np.full(count, np.inf), np.full(count, -1, dtype=np.int32))

    def add(self, distances: Array, geoms: Any) -> None:
        """Adds the hits of the same rays that are nearer.

        Args:
            distances: Their distances, m.
            geoms: Their geoms, or a single one.
        """
        closer = distances < self.distances
        np.copyto(self.distances, distances, where=closer)
        np.copyto(self.geoms, geoms, where=closer)

    def add_some(self, rays: Any, distances: Array, geoms: Any) -> None:
        """Adds the hits of some rays that are nearer.

        Args:
            rays: Indices of the rays, without repetitions.
            distances: Their distances, m.
            geoms: Their geoms.
        """
        closer = distances < self.distances[rays]
        which = rays[closer]
        self.distances[which], self.geoms[which] = distances[closer], geoms[closer]

    def add_any(self, rays: Any, distances: Array, geoms: Any) -> None:
        """Adds hits that are nearer, as `add_some`, also several of a ray."""
        np.minimum.at(self.distances, rays, distances)
        nearest = (distances == self.distances[rays]) & np.isfinite(distances)
        self.geoms[rays[nearest]] = geoms[nearest]


@dataclass(slots=True)
class Band:
    """Directions near the plane across an axis, such as those of a lidar."""

    axis: Array
    """Unit vector."""
    sine: float
    """Sine of the largest angle between a direction and the plane."""
    cosine: float
    """Its cosine."""

    @classmethod
    def of(cls, rays: Array) -> Band:
        """The band of some rays. Its axis is the direction in which they differ least."""
        values, vectors = np.linalg.eigh(rays.T @ rays)
        axis = vectors[:, int(np.argmin(values))]
        largest = math.asin(min(1.0, float(np.abs(rays @ axis).max())))
        angle = min(largest + _SLACK, math.pi / 2)
        return cls(axis, math.sin(angle), math.cos(angle))

    def meets(
        self, axis: Array, away: Array, squared: Array, radius: Array, extent: Array
    ) -> Any:  # fmt: skip
        """Whether shapes may be in the band.

        Args:
            axis: The axis of the band in their axes.
            away: Their centres, seen from the start of the rays, m, shape (n, 3).
            squared: Square of the length of `away`, shape (n,).
            radius: Radii of spheres around them, m, shape (n,).
            extent: How far they extend along the axis from their centres, m, shape (n,).
        """
        along = np.abs(away @ axis)
        across = np.sqrt(np.maximum(squared - along * along, 0.0))
        # Distances of the centres to the line of the cone around the directions that is nearest.
        distance = along * self.cosine - across * self.sine
        return distance <= np.minimum(radius, radius * self.sine + extent * self.cosine)


@dataclass(slots=True)
class Query:
    """Rays that start at one point, and what they hit."""

    start: Array
    """m, shape (3,)."""
    rays: Array
    """Unit vectors, shape (n, 3)."""
    own: Any
    """Whether each geom belongs to the sensor's model. One more entry is for geom -1."""
    minimum: float
    """Geoms of this model that a ray hits nearer than this are not hit by this ray, m."""
    maximum: float = np.inf
    """Farther hits are not needed, m."""
    hidden: frozenset[int] = frozenset()
    """Geoms that are not hit."""
    band: Band | None = None
    """Where the rays go, in the axes of the sensor's body."""
    turn: Array | None = None
    """Rotation matrix of this body."""

    def some(self, rays: Any, hidden: frozenset[int]) -> Query:
        """The same for some of the rays, and with other geoms that are not hit."""
        return replace(self, rays=self.rays[rays], hidden=hidden)
