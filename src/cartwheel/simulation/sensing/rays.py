"""Rays from a link into the world, for laser scanners and sonars.

A sensor does not measure two groups of its own robot's shapes: shapes that enclose the sensor,
which are its housing, and shapes closer than the minimum range.

The rays of a sensor are grouped into bundles with similar directions. For each bundle, only the
shapes in its cone are tested, the nearest first. In a house with 1,470 shapes, this halves the
time for a lidar with 16 x 1800 rays.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from typing import Any

import mujoco
import numpy as np

from cartwheel.geometry import Array, Pose, matrix_from_quat
from cartwheel.simulation.sensing.visual_model import VisualModel
from cartwheel.world.bodies import COLLISION_GROUP
from cartwheel.world.entry import scoped
from cartwheel.world.visuals import HIDDEN_GROUP, VISUAL_GROUP

_NO_LIMIT = 1e10
"""m; the engine's own cutoff would miss planes whose frame is farther away."""
_AXES = np.vstack([np.eye(3), -np.eye(3)])
_MESH = mujoco.mjtGeom.mjGEOM_MESH
_BUNDLE_RAYS = 64
_MOST_BUNDLES = 48
_SLACK = 1e-6
"""rad."""
_FIRST_SHAPES = 16
"""Number of geoms tested first; doubled in each iteration."""
_WORTH_SORTING = 50_000
"""Rays times geoms; below it, testing all geoms at once is faster."""
_ROUNDING = 1e-6
"""m."""


class _Bundles:
    """Rays grouped by similar directions, so that few geoms are relevant to each group.

    Args:
        directions: Unit vectors, shape (n, 3).
    """

    def __init__(self, directions: Array) -> None:
        count = len(directions)
        azimuth = np.arctan2(directions[:, 1], directions[:, 0])
        self.order: Any = np.argsort(azimuth, kind="stable")
        """The original index of each sorted ray."""
        self.directions: Array = directions[self.order]
        number = min(max(1, count // _BUNDLE_RAYS), _MOST_BUNDLES)
        edges = np.linspace(0, count, number + 1).astype(int).tolist()
        self.parts = [slice(*pair) for pair in itertools.pairwise(edges)]
        """The range of sorted rays in each bundle."""
        sums = np.array([self.directions[part].sum(axis=0) for part in self.parts])
        lengths = np.linalg.norm(sums, axis=1)
        self.axes: Array = sums / np.maximum(lengths, 1e-9)[:, None]
        """Axes of the cones around the bundles, shape (bundles, 3)."""
        cosines = [
            (self.directions[part] @ axis).min()
            for part, axis in zip(self.parts, self.axes, strict=True)
        ]
        self.angles: Array = np.arccos(np.clip(cosines, -1.0, 1.0)) + _SLACK
        """Half-angles of the cones, rad, shape (bundles,)."""
        # Rays in all directions have no mean direction, so their cone is the whole sphere.
        self.angles[lengths < 1e-6] = np.pi


class RayHandle:
    """A bundle of rays from one point on a link.

    The rays ignore geoms of the same model that enclose the point, such as the sensor's housing,
    and geoms of the same model nearer than `minimum`. They hit everything else.

    Args:
        model: Model name.
        link: Link name.
        pose: Pose of the sensor in the link.
        directions: Unit vectors in the sensor's axes, shape (n, 3).
        minimum: Minimum measured distance, m.
        maximum: Maximum measured distance, m; may be inf.
        visuals: Visuals to hit, as a GPU sensor does, instead of collisions.
    """

    def __init__(
        self,
        model: str,
        link: str,
        pose: Pose,
        directions: Array,
        *,
        minimum: float,
        maximum: float,
        visuals: VisualModel | None = None,
    ) -> None:
        self.model_name = model
        self.link_name = link
        self.minimum = minimum
        self.maximum = maximum
        self._offset = np.array(pose.position)
        self._bundles = _Bundles(np.asarray(directions) @ matrix_from_quat(pose.orientation).T)
        self._groups = np.zeros(mujoco.mjNGROUP, dtype=np.uint8)
        self._groups[COLLISION_GROUP if visuals is None else VISUAL_GROUP] = 1
        self._visuals = visuals
        self._model: Any = None
        count = len(directions)
        self._geoms = np.full(count, -1, dtype=np.int32)
        self._distances = np.zeros(count)
        self._housing: Array | None = None

    def bind(self, model: Any, data: Any) -> None:
        """Resolves names in a compiled model."""
        if self._visuals is None:
            self._resolve(model, data)

    def _resolve(self, model: Any, data: Any) -> None:
        self._model, self._data = model, data
        body = mujoco.mj_name2id(
            model, mujoco.mjtObj.mjOBJ_BODY, scoped(self.model_name, self.link_name)
        )
        self._body = body
        prefix = scoped(self.model_name, "")
        own = np.array([model.body(i).name.startswith(prefix) for i in range(model.nbody)])
        self._own = own[model.geom_bodyid]
        retros = model.geom_user[:, 0] if model.nuser_geom else np.zeros(model.ngeom)
        # One more entry, for geom -1 of a ray without a hit.
        self._retros = np.append(retros, 0.0)
        # Determined at the first cast, because the new model has no computed poses yet.
        self._housing = None

    def cast(self) -> tuple[Array, Array]:
        """Casts all rays in the state of the last forward pass.

        Returns:
            Distances in m, shape (n,): -inf for hits nearer than `minimum`, inf without a hit
            within `maximum` (REP 117); and the laser_retro of each hit, shape (n,), 0 without a
            hit.

        Raises:
            WorldError: A visual cannot be built.
        """
        if self._visuals is not None:
            model, data = self._visuals.current()
            if model is not self._model:
                self._resolve(model, data)
        turn = self._data.xmat[self._body].reshape(3, 3)
        start = self._data.xpos[self._body] + turn @ self._offset
        rays = self._bundles.directions @ turn.T
        model = self._model
        groups, trees, counts = model.geom_group, model.body_bvhadr, model.body_geomnum
        saved_groups, saved_trees, saved_counts = groups.copy(), trees.copy(), counts.copy()
        if self._housing is None:
            self._housing = self._enclosing(start)
        distances, geoms = self._distances, self._geoms
        distances[:] = -1.0
        geoms[:] = -1
        try:
            # The engine's bounding tests for bodies ignore the body's rotation and miss geoms.
            # Without tree addresses, it skips these tests; the bundles replace them.
            trees[:] = -1
            open_groups = saved_groups.copy()
            open_groups[self._housing] = HIDDEN_GROUP
            away: Array | None = None
            for part, visible in self._candidates(start, turn, open_groups):
                if (part.stop - part.start) * model.ngeom < _WORTH_SORTING:
                    groups[:] = np.where(visible, open_groups, HIDDEN_GROUP)
                    self._cast(start, rays[part], distances[part], geoms[part])
                    continue
                if away is None:
                    away = self._box_distances(start)
                shapes = np.flatnonzero(visible)
                shapes = shapes[np.argsort(away[shapes], kind="stable")]
                self._cast_outwards(
                    start,
                    rays[part],
                    distances[part],
                    geoms[part],
                    shapes=shapes,
                    near=away[shapes],
                    open_groups=open_groups,
                    all_counts=saved_counts,
                )
                counts[:] = saved_counts
            groups[:] = open_groups
            while True:
                near = np.flatnonzero((distances >= 0) & (distances < self.minimum))
                near = near[self._own[geoms[near]]]
                if not near.size:
                    break
                groups[np.unique(geoms[near])] = HIDDEN_GROUP
                again, others = np.empty(near.size), np.empty(near.size, dtype=np.int32)
                self._cast(start, rays[near], again, others)
                distances[near], geoms[near] = again, others
        finally:
            groups[:], counts[:] = saved_groups, saved_counts
            trees[:] = saved_trees
        far = (distances < 0) | (distances >= self.maximum)
        order = self._bundles.order
        measured, retros = np.empty_like(distances), np.empty_like(distances)
        measured[order] = np.where(
            far, np.inf, np.where(distances <= self.minimum, -np.inf, distances)
        )
        retros[order] = np.where(far, 0.0, self._retros[geoms])
        return measured, retros

    def _candidates(self, start: Array, turn: Array, groups: Any) -> Iterator[tuple[slice, Any]]:
        """The bundles that may hit something, each with the geoms that its cone may touch."""
        model = self._model
        away = self._data.geom_xpos - start
        distance = np.linalg.norm(away, axis=1)
        radius = model.geom_rbound
        endless = radius <= 0
        inside = distance <= radius
        seen = (self._groups[groups] == 1) & (endless | (distance - radius < self.maximum))
        beyond = np.where(endless | inside, 1.0, distance)
        width = np.arcsin(np.where(endless | inside, 1.0, radius / beyond))
        cosine = (self._bundles.axes @ turn.T @ away.T) / beyond
        angle = np.arccos(np.clip(cosine, -1.0, 1.0))
        touched = seen & (endless | inside | (angle <= self._bundles.angles[:, None] + width))
        for part, visible in zip(self._bundles.parts, touched, strict=True):
            if visible.any():
                yield part, visible

    def _box_distances(self, start: Array) -> Array:
        """Lower bounds of the distances to each geom's bounding box, m; 0 or less inside."""
        data, boxes = self._data, self._model.geom_aabb
        turns = data.geom_xmat.reshape(-1, 3, 3)
        place = np.einsum("gji,gj->gi", turns, start - data.geom_xpos) - boxes[:, :3]
        outside = np.maximum(np.abs(place) - boxes[:, 3:], 0.0)
        outside[self._model.geom_rbound <= 0] = 0.0
        distances: Array = np.linalg.norm(outside, axis=1) - _ROUNDING
        return distances

    def _cast_outwards(
        self,
        start: Array,
        rays: Array,
        distances: Array,
        geoms: Any,
        *,
        shapes: Any,
        near: Array,
        open_groups: Any,
        all_counts: Any,
    ) -> None:
        """Fills in distances and geoms, in batches of geoms from near to far.

        A ray with a hit nearer than all remaining geoms is finished. The engine tests all geoms of
        all bodies for each ray, so the geoms of irrelevant bodies are hidden meanwhile.
        """
        model = self._model
        groups, counts = model.geom_group, model.body_geomnum
        going = np.arange(len(rays))
        first, count = 0, _FIRST_SHAPES
        while first < len(shapes) and going.size:
            some = shapes[first : first + count]
            groups[:] = HIDDEN_GROUP
            groups[some] = open_groups[some]
            bodies = model.geom_bodyid[some]
            counts[:] = 0
            counts[bodies] = all_counts[bodies]
            found, hit = np.empty(going.size), np.empty(going.size, dtype=np.int32)
            self._cast(start, rays[going], found, hit)
            known = distances[going]
            closer = (found >= 0) & ((known < 0) | (found < known))
            distances[going[closer]], geoms[going[closer]] = found[closer], hit[closer]
            first += count
            count *= 2
            if first < len(shapes):
                known = distances[going]
                going = going[(known < 0) | (known > near[first])]

    def _cast(self, start: Array, rays: Array, distances: Array, geoms: Any) -> None:
        """Fills in distances, -1 without a hit, and the geoms that were hit."""
        mujoco.mj_multiRay(
            self._model,
            self._data,
            start,
            rays.reshape(-1),
            self._groups,
            True,
            -1,
            geoms,
            distances,
            None,
            len(distances),
            _NO_LIMIT,
        )

    def _enclosing(self, start: Array) -> Array:
        """Geoms that move with the sensor and contain its origin.

        From inside a convex shape, every ray hits it; from outside, two opposite rays cannot both
        hit it. For a mesh, the test finds walls on all sides.
        """
        model = self._model
        rigid = model.body_weldid[model.geom_bodyid] == model.body_weldid[self._body]
        seen = self._groups[model.geom_group] == 1
        found = []
        for geom in np.flatnonzero(self._own & rigid & seen).tolist():
            hits = (self._distance(geom, start, axis) for axis in _AXES)
            if all(hit >= 0 for hit in hits):
                found.append(geom)
        return np.array(found, dtype=np.intp)

    def _distance(self, geom: int, start: Array, direction: Array) -> float:
        model, data = self._model, self._data
        if model.geom_type[geom] == _MESH:
            return float(mujoco.mj_rayMesh(model, data, geom, start, direction))
        return float(
            mujoco.mju_rayGeom(
                data.geom_xpos[geom],
                data.geom_xmat[geom],
                model.geom_size[geom],
                start,
                direction,
                model.geom_type[geom],
            )
        )
