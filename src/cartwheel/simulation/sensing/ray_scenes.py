"""The shapes of a MuJoCo model for rays.

Shapes that stand still and meshes are triangles for Embree, grouped by the bodies that move
together. Other shapes that move are few, and are tested directly.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from cartwheel.geometry import Array, matrix_from_quat
from cartwheel.simulation.sensing import ray_shapes as shapes
from cartwheel.simulation.sensing.ray_query import Hits, Query
from cartwheel.simulation.sensing.ray_triangles import Poses, TriangleScene


@dataclass(frozen=True, slots=True)
class _Group:
    """Geoms that move together."""

    root: int
    """The body whose frame they have; 0 is the world."""
    geoms: Any
    centre: Array
    """Centre of a sphere around them, in the frame of the root, m."""
    radius: float


class RayScenes:
    """The shapes of a MuJoCo model for rays.

    Args:
        model: The model.
        data: Its data.
        group: The geoms of this group are hit, except invisible ones.
    """

    def __init__(self, model: Any, data: Any, group: int) -> None:
        self.model, self.data, self._group = model, data, group
        self._roots = np.asarray(model.body_weldid).copy()
        # Bodies that programs move are welded to the world by name only.
        for body in range(1, model.nbody):
            if model.body_mocapid[body] >= 0:
                self._roots[body] = body
            elif self._roots[body] == 0:
                self._roots[body] = self._roots[model.body_parentid[body]]
        self._state: tuple[bytes, ...] = ()
        self.version = 0
        """Changes when the shapes have changed."""
        self._scenes: dict[tuple[int, bytes], TriangleScene] = {}

    def refresh(self) -> None:
        """Follows changes of the model: what is invisible, and where it stands."""
        model = self.model
        state = tuple(
            each.tobytes()
            for each in (
                model.body_pos, model.body_quat, model.geom_group, model.geom_rgba,
                model.geom_matid, model.mat_rgba,
            )
        )  # fmt: skip
        if state == self._state:
            return
        self._state = state
        self.version += 1
        self._scenes.clear()
        self._bodies = _body_places(model, self._roots)
        self._places = _geom_places(model, self._bodies)
        opaque = model.geom_rgba[:, 3] != 0
        if model.nmat:
            painted = model.geom_matid >= 0
            opaque = np.where(painted, model.mat_rgba[model.geom_matid, 3] != 0, opaque)
        seen = (model.geom_group == self._group) & opaque
        kinds = model.geom_type
        roots = self._roots[model.geom_bodyid]
        self._planes = np.flatnonzero(seen & (kinds == shapes.PLANE)).tolist()
        solid = seen & (kinds != shapes.PLANE)
        simple = np.isin(kinds, list(shapes.TO_SHAPE))
        moving = np.flatnonzero(solid & (roots != 0) & simple)
        self._simple = moving[np.argsort(kinds[moving], kind="stable")].astype(np.int32)
        """Geoms that move and are no meshes, sorted by their kinds."""
        self._simple_roots = roots[self._simple]
        self._radii = model.geom_rbound[self._simple].copy()
        self.fixed = np.flatnonzero(solid & (roots == 0))
        self._groups = [
            self._group_of(root, np.flatnonzero(solid & (roots == root) & ~simple))
            for root in np.unique(roots[solid & (roots != 0) & ~simple]).tolist()
        ]

    def root_of(self, body: int) -> int:
        """The body that a body moves with; 0 is the world."""
        return int(self._roots[body])

    def place_of(self, body: int) -> Poses:
        """Pose of a body in the frame of its root body."""
        return self._bodies[0][body], self._bodies[1][body]

    def cast_planes(self, query: Query, hits: Hits) -> None:
        """Adds the hits of planes."""
        data, model = self.data, self.model
        for geom in self._planes:
            if geom in query.hidden:
                continue
            turn = data.geom_xmat[geom].reshape(3, 3)
            here = (query.start - data.geom_xpos[geom]) @ turn
            found = shapes.to_plane(here, query.rays @ turn, model.geom_size[geom])
            hits.add(Hits(found, np.full(len(found), geom, dtype=np.int32)))

    def cast_fixed(self, query: Query, hits: Hits) -> None:
        """Adds the hits of all that stands still."""
        if len(self.fixed):
            hits.add(self._cast_clear(0, self.fixed, query))

    def cast_with(self, root: int, query: Query) -> Hits:
        """The hits of all that moves with a body, in its frame."""
        meshes = [group.geoms for group in self._groups if group.root == root]
        geoms = np.concatenate([self._simple[self._simple_roots == root], *meshes])
        return self._cast_clear(root, geoms, query)

    def cast_moving(self, query: Query, hits: Hits, *, without: int) -> None:
        """Adds the hits of all that moves.

        Args:
            query: The rays.
            hits: Hits so far.
            without: What moves with this body is left out, unless it is the world.
        """
        self._cast_simple(query, hits, without)
        for group in self._groups:
            if group.root != without:
                self._cast_group(group, query, hits)

    def _cast_simple(self, query: Query, hits: Hits, without: int) -> None:
        model, data = self.model, self.data
        geoms, radius = self._simple, self._radii
        if not geoms.size:
            return
        away = data.geom_xpos[geoms] - query.start
        squared = np.einsum("ij,ij->i", away, away)
        distance = np.sqrt(squared)
        wanted = distance - radius < query.maximum
        wanted &= self._simple_roots != without
        if query.band is not None:
            wanted &= query.band.meets(away, distance, radius)
        if not wanted.any():
            return
        geoms, away, squared = geoms[wanted], away[wanted], squared[wanted]
        # A ray meets the sphere around a geom if it goes far enough along the line to its centre.
        rest = squared - radius[wanted] ** 2
        least = np.where(rest > 0, np.sqrt(np.maximum(rest, 0.0)), -np.inf)[:, None]
        # A matrix product of this size would wait for other threads, which a busy machine delays.
        along = np.multiply.outer(away[:, 0], query.rays[:, 0])
        along += np.multiply.outer(away[:, 1], query.rays[:, 1])
        along += np.multiply.outer(away[:, 2], query.rays[:, 2])
        flat = np.flatnonzero(along >= least)
        if not flat.size:
            return
        first = np.searchsorted(flat, np.arange(len(geoms) + 1) * len(query.rays)).tolist()
        found = np.empty(flat.size)
        row, which = np.divmod(flat, len(query.rays))
        met = geoms[row]
        starts, rays = np.empty((flat.size, 3)), query.rays[which]
        turns = data.geom_xmat[geoms].reshape(-1, 3, 3)
        for index in range(len(geoms)):
            part = slice(first[index], first[index + 1])
            if part.start < part.stop:
                starts[part] = -away[index] @ turns[index]
                rays[part] = rays[part] @ turns[index]
        # The geoms are sorted by their kinds.
        sizes, kinds = model.geom_size[met], model.geom_type[met]
        edges = [0, *(np.flatnonzero(np.diff(kinds)) + 1).tolist(), flat.size]
        for low, high in itertools.pairwise(edges):
            part = slice(low, high)
            to_shape = shapes.TO_SHAPE[int(kinds[low])]
            found[part] = to_shape(starts[part], rays[part], sizes[part])
        found[query.own[met] & (found < query.minimum)] = np.inf
        hits.add_any(which, Hits(found, met))

    def _cast_group(self, group: _Group, query: Query, hits: Hits) -> None:
        turn = self.data.xmat[group.root].reshape(3, 3)
        place = self.data.xpos[group.root]
        away = place + turn @ group.centre - query.start
        squared = float(away @ away)
        if np.sqrt(squared) - group.radius >= query.maximum:
            return
        rest = squared - group.radius**2
        along = (query.rays * away).sum(axis=1)
        (which,) = np.nonzero(along >= (np.sqrt(rest) if rest > 0 else -np.inf))
        if which.size:
            start, rays = (query.start - place) @ turn, query.rays[which] @ turn
            there = replace(query, start=start, rays=rays)
            hits.add_some(which, self._cast_clear(group.root, group.geoms, there))

    def _cast_clear(self, root: int, geoms: Any, query: Query) -> Hits:
        """The hits of geoms that move together, in the frame of their root."""
        hits = self._cast_scene(root, geoms, query)
        if query.minimum > 0:
            near = (hits.distances < query.minimum) & query.own[hits.geoms]
            if near.any():
                for geom in np.unique(hits.geoms[near]).tolist():
                    (again,) = np.nonzero(near & (hits.geoms == geom))
                    other = replace(query.some(again), hidden=query.hidden | {geom})
                    found = self._cast_clear(root, geoms, other)
                    hits.distances[again], hits.geoms[again] = found.distances, found.geoms
                    near[again] = False
        return hits

    def _cast_scene(self, root: int, geoms: Any, query: Query) -> Hits:
        if query.hidden:
            geoms = geoms[~np.isin(geoms, list(query.hidden))]
        if not len(geoms):
            return Hits.none(len(query.rays))
        key = (root, geoms.tobytes())
        scene = self._scenes.get(key)
        if scene is None:
            scene = self._scenes[key] = TriangleScene(self.model, geoms, self._places)
        return scene.cast(query.start, query.rays)

    def _group_of(self, root: int, geoms: Any) -> _Group:
        places, turns = self._places
        boxes = self.model.geom_aabb[geoms]
        middles = np.einsum("gij,gj->gi", turns[geoms], boxes[:, :3]) + places[geoms]
        radii = np.linalg.norm(boxes[:, 3:], axis=1)
        low, high = (middles - radii[:, None]).min(axis=0), (middles + radii[:, None]).max(axis=0)
        centre = (low + high) / 2
        radius = float((np.linalg.norm(middles - centre, axis=1) + radii).max())
        # Meshes are in single precision.
        return _Group(root, geoms, centre, radius * (1 + 1e-6) + 1e-6)


def _body_places(model: Any, roots: Any) -> Poses:
    """Pose of each body in the frame of its root body.

    They are computed from the model alone: a state may have other roundings at other times.
    """
    positions = np.zeros((model.nbody, 3))
    turns = np.tile(np.eye(3), (model.nbody, 1, 1))
    for body in range(1, model.nbody):
        if roots[body] != body:
            parent = model.body_parentid[body]
            positions[body] = positions[parent] + turns[parent] @ model.body_pos[body]
            turns[body] = turns[parent] @ _turn(model.body_quat[body])
    return positions, turns


def _geom_places(model: Any, bodies: Poses) -> Poses:
    """Pose of each geom in the frame of its root body."""
    positions, turns = bodies[0][model.geom_bodyid], bodies[1][model.geom_bodyid]
    own = np.array([_turn(quat) for quat in model.geom_quat]).reshape(-1, 3, 3)
    return (
        positions + np.einsum("gij,gj->gi", turns, model.geom_pos),
        np.einsum("gij,gjk->gik", turns, own),
    )


def _turn(quat: Array) -> Array:
    """Rotation matrix of a quaternion of MuJoCo, which begins with w."""
    w, x, y, z = quat / np.linalg.norm(quat)
    return matrix_from_quat((x, y, z, w))
