"""Rays that start at one point, and what they hit."""

from __future__ import annotations

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

    def add(self, other: Hits) -> None:
        """Adds the hits of the same rays that are nearer."""
        closer = other.distances < self.distances
        np.copyto(self.distances, other.distances, where=closer)
        np.copyto(self.geoms, other.geoms, where=closer)

    def add_some(self, rays: Any, other: Hits) -> None:
        """Adds the hits of some rays that are nearer.

        Args:
            rays: Indices of the rays, without repetitions.
            other: Their hits.
        """
        closer = other.distances < self.distances[rays]
        which = rays[closer]
        self.distances[which], self.geoms[which] = other.distances[closer], other.geoms[closer]

    def add_any(self, rays: Any, other: Hits) -> None:
        """Adds hits that are nearer, also several of a ray."""
        np.minimum.at(self.distances, rays, other.distances)
        nearest = (other.distances == self.distances[rays]) & np.isfinite(other.distances)
        self.geoms[rays[nearest]] = other.geoms[nearest]


@dataclass(frozen=True, slots=True)
class Band:
    """Directions between two cones about an axis, such as those of a lidar."""

    axis: Array
    """Unit vector."""
    low: float
    """Smallest angle between a direction and the plane across the axis, rad."""
    high: float
    """Largest angle, rad."""

    @classmethod
    def of(cls, rays: Array) -> Band:
        """The band of some rays. Its axis is the direction in which they differ least."""
        values, vectors = np.linalg.eigh(rays.T @ rays)
        axis = vectors[:, int(np.argmin(values))]
        angles = np.arcsin(np.clip(rays @ axis, -1.0, 1.0))
        return cls(axis, float(angles.min()) - _SLACK, float(angles.max()) + _SLACK)

    def turned(self, turn: Array) -> Band:
        """The band in other axes."""
        return replace(self, axis=turn @ self.axis)

    def meets(self, away: Array, distance: Array, radius: Array) -> Any:
        """Whether spheres may be in the band.

        Args:
            away: Their centres, seen from the start of the rays, m, shape (n, 3).
            distance: Length of `away`, shape (n,).
            radius: Their radii, m, shape (n,).
        """
        outside = np.maximum(distance, radius)
        outside = np.maximum(outside, 1e-12)
        width = np.arcsin(np.minimum(radius / outside, 1.0))
        angle = np.arcsin(np.clip(away @ self.axis / outside, -1.0, 1.0))
        inside = distance <= radius
        return inside | ((angle + width >= self.low) & (angle - width <= self.high))


@dataclass(frozen=True, slots=True)
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
    """Where the rays go."""

    def some(self, rays: Any) -> Query:
        """The same for some of the rays."""
        return replace(self, rays=self.rays[rays])
