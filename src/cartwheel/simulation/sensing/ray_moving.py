"""Shapes that move, for rays: those that may be hit are chosen, and are then tested."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from cartwheel.geometry import Array
from cartwheel.simulation.sensing import ray_shapes as shapes
from cartwheel.simulation.sensing.ray_query import Hits, Query
from cartwheel.simulation.sensing.ray_triangles import RigidShapes

_SMALL_PRODUCT = 1 << 16
"""Numbers of a matrix product that one thread computes."""


@dataclass(frozen=True, slots=True)
class RigidMeshes:
    """Meshes that move with a body."""

    root: int
    """The body."""
    shapes: RigidShapes
    """In the frame of the body."""
    centre: Array
    """Centre of a sphere around them, in the frame of the body, m."""
    radius: float
    """Radius of this sphere, m."""


class MovingShapes:
    """Shapes that move and do not move with the sensor.

    Args:
        model: The MuJoCo model.
        data: Its data.
        simple: Geoms that are no meshes, sorted by their kinds.
        meshes: Meshes, by the bodies that they move with.
    """

    def __init__(
        self, model: Any, data: Any, simple: Any, meshes: Sequence[RigidMeshes]
    ) -> None:  # fmt: skip
        self._body_positions, self._body_turns = data.xpos, data.xmat.reshape(-1, 3, 3)
        self._positions, self._turns = data.geom_xpos, data.geom_xmat.reshape(-1, 3, 3)
        self._sizes, self._kinds = model.geom_size, model.geom_type
        self._simple, self._meshes = simple, meshes
        self._roots = np.array([each.root for each in meshes], dtype=np.intp)
        self._centres = np.array([each.centre for each in meshes]).reshape(-1, 3)
        radii = [each.radius for each in meshes]
        self._radii = np.concatenate([model.geom_rbound[simple], radii])
        self._halves = model.geom_aabb[simple, 3:]

    def cast(self, query: Query, hits: Hits) -> None:
        """Adds the hits of rays."""
        if not self._radii.size:
            return
        away = self._places() - query.start
        squared = np.einsum("ij,ij->i", away, away)
        wanted = np.sqrt(squared) - self._radii < query.maximum
        if query.band is not None:
            extent = self._extent(query.band.axis)
            wanted &= query.band.meets(away, squared, self._radii, extent)
        (chosen,) = np.nonzero(wanted)
        if not chosen.size:
            return
        # A ray meets a sphere if it goes far enough along the line to its centre.
        rest = squared - self._radii**2
        least = np.where(rest > 0, np.sqrt(np.maximum(rest, 0.0)), -np.inf)
        count = int(np.searchsorted(chosen, len(self._simple)))
        if count:
            few = chosen[:count]
            self._cast_simple(self._simple[few], away[few], least[few], query, hits)
        for index in chosen[count:].tolist():
            meshes = self._meshes[index - len(self._simple)]
            self._cast_meshes(meshes, away[index], least[index], query, hits)

    def _places(self) -> Array:
        """The centres of all spheres, m."""
        places: Array = self._positions.take(self._simple, axis=0)
        if self._meshes:
            turns = self._body_turns.take(self._roots, axis=0)
            centres = np.einsum("gij,gj->gi", turns, self._centres)
            centres += self._body_positions.take(self._roots, axis=0)
            places = np.concatenate([places, centres])
        return places

    def _extent(self, axis: Array) -> Array:
        """How far all shapes extend along an axis from the centres of their spheres, m."""
        turned = np.einsum("gij,i->gj", self._turns.take(self._simple, axis=0), axis)
        extent: Array = np.einsum("gj,gj->g", np.abs(turned, out=turned), self._halves)
        return np.concatenate([extent, self._radii[extent.size :]]) if self._meshes else extent

    def _cast_simple(
        self, geoms: Any, away: Array, least: Array, query: Query, hits: Hits
    ) -> None:  # fmt: skip
        along = _along(away, query.rays)
        flat = np.flatnonzero(along >= least[:, None])
        if not flat.size:
            return
        edges = np.searchsorted(flat, np.arange(len(geoms) + 1) * len(query.rays))
        row = np.repeat(np.arange(len(geoms)), np.diff(edges))
        which = flat - row * len(query.rays)
        turns = self._turns[geoms]
        starts = np.einsum("gj,gjk->gk", -away, turns)[row]
        rays = np.einsum("ij,ijk->ik", query.rays[which], turns[row])
        # The geoms are sorted by their kinds.
        met = geoms[row]
        sizes, kinds = self._sizes[met], self._kinds[geoms].tolist()
        found = np.empty(row.size)
        first = 0
        for kind, group in itertools.groupby(kinds):
            last = first + len(list(group))
            part = slice(int(edges[first]), int(edges[last]))
            first = last
            if part.start < part.stop:
                found[part] = shapes.TO_SHAPE[kind](starts[part], rays[part], sizes[part])
        if query.own[geoms].any():
            found[query.own[met] & (found < query.minimum)] = np.inf
        hits.add_any(which, found, met)

    def _cast_meshes(
        self, meshes: RigidMeshes, away: Array, least: float, query: Query, hits: Hits
    ) -> None:
        along = np.einsum("ij,j->i", query.rays, away)
        (which,) = np.nonzero(along >= least)
        if which.size:
            turn = self._body_turns[meshes.root]
            start = (query.start - self._body_positions[meshes.root]) @ turn
            there = Query(start, query.rays[which] @ turn, query.own, query.minimum,
                          hidden=query.hidden)  # fmt: skip
            found = meshes.shapes.cast(there)
            hits.add_some(which, found.distances, found.geoms)


def _along(away: Array, rays: Array) -> Array:
    """How far each ray goes until it is nearest to each point, m, shape (points, rays)."""
    along: Array
    if len(away) * len(rays) <= _SMALL_PRODUCT:
        along = away @ rays.T
        return along
    # A matrix product of this size would wait for other threads, which a busy machine delays.
    along = np.multiply.outer(away[:, 0], rays[:, 0])
    along += np.multiply.outer(away[:, 1], rays[:, 1])
    along += np.multiply.outer(away[:, 2], rays[:, 2])
    return along
