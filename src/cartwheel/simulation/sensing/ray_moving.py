"""Shapes that move, for rays: those that may be hit are chosen, and are then tested."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from cartwheel.geometry import Array
from cartwheel.simulation.sensing import ray_shapes as shapes
from cartwheel.simulation.sensing.ray_query import Hits, Query
from cartwheel.simulation.sensing.ray_triangles import RigidShapes

_FEW_PAIRS = 1 << 14
"""With fewer pairs of a shape and a ray, leaving out shapes that no ray can reach takes longer."""
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
        self._simple, self._meshes = simple.astype(np.intp), meshes
        kinds, firsts = np.unique(self._kinds[simple], return_index=True)
        self._simple_kinds = kinds.tolist()
        self._groups = np.concatenate([firsts, len(simple) + np.arange(len(meshes) + 1)])
        """Where each kind of simple shapes and each body with meshes begins, and the end."""
        self._roots = np.array([each.root for each in meshes], dtype=np.intp)
        self._centres = np.array([each.centre for each in meshes]).reshape(-1, 3)
        radii = [each.radius for each in meshes]
        self._radii = np.concatenate([model.geom_rbound[simple], radii])
        self._radii_squared = self._radii**2
        self._halves = model.geom_aabb[simple, 3:]

    def cast(self, query: Query, hits: Hits) -> None:
        """Adds the hits of rays."""
        count = len(self._radii)
        if not count:
            return
        away = self._places() - query.start
        squared = np.einsum("ij,ij->i", away, away)
        # A ray meets a sphere if it goes far enough along the line to its centre. The root is NaN
        # if the ray starts in the sphere, and nothing is less.
        least, groups = np.sqrt(squared - self._radii_squared), self._groups
        chosen: Any = None
        if count * len(query.rays) > _FEW_PAIRS:
            (chosen,) = self._reachable(query, away, squared).nonzero()
            if not chosen.size:
                return
            away, least, groups = away[chosen], least[chosen], chosen.searchsorted(groups)
        missed = _along(away, query.rays) < least[:, None]
        (pairs,) = np.logical_not(missed, out=missed).ravel().nonzero()
        if not pairs.size:
            return
        row, which = np.divmod(pairs, len(query.rays))
        edges = row.searchsorted(groups).tolist()
        kinds = len(self._simple_kinds)
        if edges[kinds]:
            few = slice(edges[kinds])
            geoms = self._simple if chosen is None else self._simple[chosen[: groups[kinds]]]
            self._cast_simple(
                query, hits, geoms=geoms, away=away[: len(geoms)],
                row=row[few], which=which[few], edges=edges[: kinds + 1],
            )  # fmt: skip
        for meshes, first, last in zip(
            self._meshes, edges[kinds:], edges[kinds + 1 :], strict=False
        ):
            if first < last:
                self._cast_meshes(meshes, which[first:last], query, hits)

    def _reachable(self, query: Query, away: Array, squared: Array) -> Any:
        """Whether any ray may reach each shape.

        Args:
            query: The rays.
            away: Centres of the spheres, seen from the start of the rays, m.
            squared: Square of the length of `away`.
        """
        found = np.sqrt(squared) - self._radii < query.maximum
        if query.band is not None and query.turn is not None:
            axis = query.turn @ query.band.axis
            found &= query.band.meets(axis, away, squared, self._radii, self._extent(axis))
        return found

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
        self,
        query: Query,
        hits: Hits,
        *,
        geoms: Any,
        away: Array,
        row: Any,
        which: Any,
        edges: Sequence[int],
    ) -> None:
        """Adds the hits of geoms that are no meshes.

        Args:
            query: The rays.
            hits: Hits so far.
            geoms: Indices of the geoms.
            away: Their places, seen from the start of the rays.
            row: The geom of each pair that may meet, as an index of `geoms`.
            which: The ray of each pair.
            edges: Where the pairs of each kind begin, and the end.
        """
        met = geoms.take(row)
        turns = self._turns.take(geoms, axis=0)
        starts = np.einsum("gj,gjk->gk", -away, turns).take(row, axis=0)
        rays = np.einsum("ij,ijk->ik", query.rays.take(which, axis=0), turns.take(row, axis=0))
        sizes = self._sizes.take(met, axis=0)
        found = np.empty(row.size)
        # The geoms are sorted by their kinds.
        for kind, first, last in zip(self._simple_kinds, edges, edges[1:], strict=False):
            if first < last:
                part = slice(first, last)
                found[part] = shapes.TO_SHAPE[kind](starts[part], rays[part], sizes[part])
        near = found < query.minimum
        if near.any():
            found[near & query.own[met]] = np.inf
        hits.add_any(which, found, met)

    def _cast_meshes(self, meshes: RigidMeshes, which: Any, query: Query, hits: Hits) -> None:
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
