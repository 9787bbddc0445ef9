"""The shapes of a MuJoCo model for rays.

Shapes that stand still and meshes are triangles for Embree, grouped by the bodies that move
together. Other shapes that move are few, and are tested directly.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from cartwheel.geometry import Array, matrix_from_quat
from cartwheel.simulation.sensing import ray_shapes as shapes
from cartwheel.simulation.sensing.ray_moving import MovingShapes, RigidMeshes
from cartwheel.simulation.sensing.ray_query import Hits, Query
from cartwheel.simulation.sensing.ray_triangles import Poses, RigidShapes


class RayScenes:
    """The shapes of a MuJoCo model for rays.

    Args:
        model: The model.
        data: Its data.
        group: The geoms of this group are hit, except invisible ones.
        moved: Returns the bodies that are fixed to the world and move at a velocity.
    """

    def __init__(
        self,
        model: Any,
        data: Any,
        group: int,
        moved: Callable[[], frozenset[int]] = frozenset,
    ) -> None:
        self.model, self.data, self._group = model, data, group
        self._find_moved = moved
        self._state: list[bytes] = []
        self._roots: Any = None
        self._follow(frozenset())
        self._watched = (model.geom_group, model.geom_rgba, model.geom_matid, model.mat_rgba)
        self.version = 0
        """Changes when the shapes have changed."""

    def refresh(self) -> None:
        """Follows changes of the model: what is invisible, and where it stands."""
        model = self.model
        moved = self._find_moved()
        if moved != self._moved:
            self._follow(moved)
        places = (model.body_pos, model.body_quat)
        if moved:
            # Their own places change in each step.
            places = tuple(np.delete(each, list(moved), axis=0) for each in places)
        state = [each.tobytes() for each in (*places, *self._watched)]
        if state == self._state:
            return
        self._state = state
        self.version += 1
        self._bodies = _body_places(model, self._roots)
        self._places = _geom_places(model, self._bodies)
        opaque = model.geom_rgba[:, 3] != 0
        if model.nmat:
            painted = model.geom_matid >= 0
            opaque = np.where(painted, model.mat_rgba[model.geom_matid, 3] != 0, opaque)
        seen = (model.geom_group == self._group) & opaque
        kinds = model.geom_type
        roots = self._roots[model.geom_bodyid]
        data = self.data
        self._planes = [
            (geom, data.geom_xpos[geom], data.geom_xmat[geom].reshape(3, 3), model.geom_size[geom])
            for geom in np.flatnonzero(seen & (kinds == shapes.PLANE)).tolist()
        ]
        solid = seen & (kinds != shapes.PLANE)
        simple = np.isin(kinds, list(shapes.TO_SHAPE))
        moving = np.flatnonzero(solid & (roots != 0) & simple)
        self._simple = moving[np.argsort(kinds[moving], kind="stable")].astype(np.int32)
        """Geoms that move and are no meshes, sorted by their kinds."""
        self._simple_roots = roots[self._simple]
        self._fixed = RigidShapes(model, np.flatnonzero(solid & (roots == 0)), self._places)
        self._meshes = [
            self._meshes_of(root, np.flatnonzero(solid & (roots == root) & ~simple))
            for root in np.unique(roots[solid & (roots != 0) & ~simple]).tolist()
        ]
        self._with: dict[int, RigidShapes] = {}
        self._without: dict[int, MovingShapes] = {}

    def _follow(self, moved: frozenset[int]) -> None:
        """Finds the body that each body moves with."""
        model, self._moved, self._state = self.model, moved, []
        roots = np.asarray(model.body_weldid).copy()
        # Bodies that programs move are welded to the world by name only.
        for body in range(1, model.nbody):
            if model.body_mocapid[body] >= 0 or body in moved:
                roots[body] = body
            elif roots[body] == 0:
                roots[body] = roots[model.body_parentid[body]]
        self._roots = roots

    def root_of(self, body: int) -> int:
        """The body that a body moves with; 0 is the world."""
        return int(self._roots[body])

    def place_of(self, body: int) -> Poses:
        """Pose of a body in the frame of its root body."""
        return self._bodies[0][body], self._bodies[1][body]

    def cast_fixed(self, query: Query) -> Hits:
        """The hits of all that stands still."""
        return self._fixed.cast(query)

    def cast_planes(self, query: Query, hits: Hits) -> None:
        """Adds the hits of planes."""
        for geom, place, turn, size in self._planes:
            if geom not in query.hidden:
                found = shapes.to_plane(query.start - place, query.rays, turn, size, query.maximum)
                if found is not None:
                    hits.add(found, geom)

    def cast_with(self, root: int, query: Query) -> Hits:
        """The hits of all that moves with a body, in its frame."""
        found = self._with.get(root)
        if found is None:
            meshes = [each.shapes.geoms for each in self._meshes if each.root == root]
            geoms = np.concatenate([self._simple[self._simple_roots == root], *meshes])
            found = self._with[root] = RigidShapes(self.model, geoms, self._places)
        return found.cast(query)

    def cast_moving(self, query: Query, hits: Hits, *, without: int) -> None:
        """Adds the hits of all that moves.

        Args:
            query: The rays.
            hits: Hits so far.
            without: What moves with this body is left out, unless it is the world.
        """
        found = self._without.get(without)
        if found is None:
            found = self._without[without] = MovingShapes(
                self.model, self.data, self._simple[self._simple_roots != without],
                [each for each in self._meshes if each.root != without],
            )  # fmt: skip
        found.cast(query, hits)

    def _meshes_of(self, root: int, geoms: Any) -> RigidMeshes:
        places, turns = self._places
        boxes = self.model.geom_aabb[geoms]
        middles = np.einsum("gij,gj->gi", turns[geoms], boxes[:, :3]) + places[geoms]
        radii = np.linalg.norm(boxes[:, 3:], axis=1)
        low, high = (middles - radii[:, None]).min(axis=0), (middles + radii[:, None]).max(axis=0)
        centre = (low + high) / 2
        radius = float((np.linalg.norm(middles - centre, axis=1) + radii).max())
        # Meshes are in single precision.
        return RigidMeshes(
            root, RigidShapes(self.model, geoms, self._places), centre, radius * (1 + 1e-6) + 1e-6
        )


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
