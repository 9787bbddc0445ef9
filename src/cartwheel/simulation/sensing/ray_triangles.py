"""Triangles of shapes that move together, for Embree.

Embree finds the triangle that a ray hits, in single precision. The distance is then computed
exactly from the shape, in double precision: it does not depend on the triangles or on their order.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from cartwheel.geometry import Array
from cartwheel.simulation.sensing import ray_shapes as shapes
from cartwheel.simulation.sensing.ray_query import Hits, Query

try:
    from embreex.mesh_construction import TriangleMesh
    from embreex.rtcore_scene import EmbreeScene
except ImportError:
    EmbreeScene = TriangleMesh = None

AVAILABLE = EmbreeScene is not None
"""Whether Embree is installed. There are no packages for all processors."""

Poses = tuple[Array, Array]
"""Positions in m, shape (3,) or (n, 3), and rotation matrices, shape (3, 3) or (n, 3, 3)."""

_CLOSE = 1e-4
"""A curved surface that is not farther than this behind its triangles hides others, m."""
_STEP = 1e-6
"""Distance by which a ray continues behind a triangle, m."""
_LONGER = 4.0
"""Factor of this distance while the ray still hits the same triangle."""
_MOST_STEPS = 64
"""Maximum number of triangles of curved shapes that a ray passes."""


class TriangleScene:
    """Triangles for Embree in the frame of a body, or in the world."""

    def __init__(self, model: Any, geoms: Any, places: Poses) -> None:
        corners, faces, owners, normals, offsets = [], [], [], [], []
        count = 0
        for geom in geoms.tolist():
            own, own_faces = shapes.triangles_of(model, geom)
            turn, place = places[1][geom], places[0][geom]
            if model.geom_type[geom] == shapes.BOX:
                # Triangles of one face are exactly in one plane.
                normal, offset = shapes.box_planes(model.geom_size[geom])
            else:
                a, b, c = (own[own_faces[:, k]] for k in range(3))
                normal = np.cross(b - a, c - a)
                offset = np.einsum("ij,ij->i", normal, a)
            normal = normal @ turn.T
            normals.append(normal)
            offsets.append(offset + normal @ place)
            corners.append(own @ turn.T + place)
            faces.append(own_faces + count)
            owners.append(np.full(len(own_faces), geom, dtype=np.int32))
            count += len(own)
        # One more entry, for triangle -1 of a ray without a hit.
        self._owners: Any = np.append(np.concatenate(owners), np.int32(-1))
        planes = np.column_stack([np.concatenate(normals), np.concatenate(offsets)])
        self._planes: Array = np.concatenate([planes, [[0.0, 0.0, 0.0, np.inf]]])
        """Normal and offset of the plane of each triangle, which are read together."""
        everything = np.concatenate(corners)
        self._centre = (everything.min(axis=0) + everything.max(axis=0)) / 2
        """Single precision suffices near it."""
        self._scene = EmbreeScene()
        TriangleMesh(
            self._scene,
            (everything - self._centre).astype(np.float32),
            np.concatenate(faces).astype(np.int32),
        )
        curved = np.isin(model.geom_type, shapes.CURVED)
        self._curved = np.append(curved, False)[self._owners] if curved[geoms].any() else None
        self._kinds = np.asarray(model.geom_type).copy()
        self._touches = np.full(len(self._kinds), True)
        """Whether each geom's triangles may meet those of another geom."""
        if self._curved is not None:
            boxes = np.array([(each.min(axis=0), each.max(axis=0)) for each in corners])
            for index in np.flatnonzero(curved[geoms]).tolist():
                low, high = boxes[index]
                meets = ((boxes[:, 0] <= high) & (low <= boxes[:, 1])).all(axis=1)
                self._touches[geoms[index]] = np.count_nonzero(meets) > 1
        self._curved_kinds = np.unique(self._kinds[geoms[curved[geoms]]]).tolist()
        # Position, rotation matrix and size of each geom, which are read together.
        self._geoms = np.hstack([places[0], places[1].reshape(-1, 9), model.geom_size])

    def find(self, start: Array, rays: Array) -> Any:
        """The triangles that rays hit, or -1.

        Args:
            start: Where each ray starts, shape (n, 3) or (3,), in the frame of the scene, m.
            rays: Unit vectors, shape (n, 3).
        """
        begin = (start - self._centre).astype(np.float32)
        if begin.ndim == 1:
            # As `broadcast_to`, which takes longer.
            begin = np.ndarray(rays.shape, np.float32, begin, strides=(0, begin.itemsize))
        # As indices, which are read several times.
        return self._scene.run(begin, rays.astype(np.float32)).astype(np.intp)

    def cast(self, start: Array, rays: Array) -> Hits:
        """The nearest hits of rays in the frame of the scene; see `Query`."""
        found = self.find(start, rays)
        distances = self._to_triangles(start, rays, found)
        hits = Hits(distances, self._owners.take(found))
        if self._curved is not None:
            (which,) = self._curved.take(found).nonzero()
            if which.size:
                self._refine(start, rays, hits, which, found[which])
        return hits

    def _to_triangles(self, start: Array, rays: Array, triangles: Any) -> Array:
        """Distances to the planes of triangles."""
        x, y, z, heights = np.ascontiguousarray(self._planes.take(triangles, axis=0).T)
        across = x * rays[:, 0]
        across += y * rays[:, 1]
        across += z * rays[:, 2]
        for part, origin in zip((x, y, z), start.tolist(), strict=True):
            heights -= np.multiply(part, origin, out=part)
        heights /= across
        distances: Array = np.abs(heights, out=heights)
        return distances

    def _refine(self, start: Array, rays: Array, hits: Hits, which: Any, triangles: Any) -> None:
        """Replaces distances to the triangles of curved shapes by those to the shapes.

        A ray may pass between a curved surface and its triangles, and hit another shape.

        Args:
            start: Where the rays start, m.
            rays: Unit vectors.
            hits: The hits of triangles.
            which: Indices of the rays that hit a curved shape.
            triangles: The triangles that these rays hit.
        """
        ray, geoms = rays.take(which, axis=0), hits.geoms.take(which)
        surface = hits.distances.take(which)
        if len(self._curved_kinds) == 1:
            kind = self._curved_kinds[0]
            exact = _to_shape(kind, start, ray, self._geoms.take(geoms, axis=0))
        else:
            exact = self._exact(start, ray, geoms, surface)
        hits.distances[which] = exact
        missed = np.isinf(exact)
        # Between its triangles and a shape, a ray hits only what meets these triangles.
        going = surface < exact - _CLOSE
        going &= missed | self._touches.take(geoms)
        (on,) = going.nonzero()
        if not on.size:
            return
        hits.geoms[which[missed]] = -1
        step = np.full(which.size, _STEP)
        for _ in range(_MOST_STEPS):
            which, ray = which.take(on), ray.take(on, axis=0)
            triangles, step = triangles.take(on), step.take(on)
            passed = surface.take(on) + step
            found = self.find(start + passed[:, None] * ray, ray)
            again = found == triangles
            # A ray that has hit a shape leaves its triangles behind it: nothing is in between.
            left = np.isfinite(exact.take(on)) & (self._owners.take(found) == geoms.take(on))
            if (left & ~again | (found < 0)).all():
                return
            # The plane of a triangle behind the start of the ray would be numerical noise.
            surface = np.maximum(self._to_triangles(start, ray, found), passed)
            # A ray that hits the same triangle again has not passed it in single precision.
            step = np.where(again, step * _LONGER, _STEP)
            # A shape is not nearer than its triangles.
            some = surface < hits.distances[which]
            some &= found >= 0
            if not some.any():
                return
            which, ray, surface = which[some], ray[some], surface[some]
            triangles, step = found[some], step[some]
            geoms = self._owners[triangles]
            exact = self._exact(start, ray, geoms, surface)
            hits.add_some(which, exact, geoms)
            (on,) = (surface < hits.distances[which] - _CLOSE).nonzero()
            if not on.size:
                return

    def _exact(self, start: Array, rays: Array, geoms: Any, surface: Array) -> Array:
        """Distances to curved shapes, inf for a miss, and otherwise those to the triangles."""
        kinds, rows = self._kinds.take(geoms), self._geoms.take(geoms, axis=0)
        exact = surface
        for kind in self._curved_kinds:
            chosen = kinds == kind
            if chosen.all():
                return _to_shape(kind, start, rays, rows)
            if chosen.any():
                if exact is surface:
                    exact = surface.copy()
                exact[chosen] = _to_shape(kind, start, rays[chosen], rows[chosen])
        return exact


def _to_shape(kind: int, start: Array, rays: Array, geoms: Array) -> Array:
    """Distances to shapes of one kind; the columns are position, rotation matrix and size."""
    turns = geoms[:, 3:12].reshape(-1, 3, 3)
    here = np.einsum("ij,ijk->ik", start - geoms[:, :3], turns)
    turned = np.einsum("ij,ijk->ik", rays, turns)
    return shapes.TO_SHAPE[kind](here, turned, geoms[:, 12:])


class RigidShapes:
    """Shapes that move together, in the frame of their body.

    Args:
        model: The MuJoCo model.
        geoms: Indices of the geoms, shape (n,).
        places: Poses of all geoms of the model in this frame.
    """

    def __init__(self, model: Any, geoms: Any, places: Poses) -> None:
        self.geoms = geoms
        self._model, self._places = model, places
        self._scenes: dict[frozenset[int], TriangleScene | None] = {}
        """By the geoms that are not hit."""

    def cast(self, query: Query) -> Hits:
        """The nearest hits of rays in this frame."""
        scene = self._scene(query.hidden)
        if scene is None:
            return Hits.none(len(query.rays))
        hits = scene.cast(query.start, query.rays)
        if hits.distances.size and hits.distances.min() < query.minimum:
            near = (hits.distances < query.minimum) & query.own[hits.geoms]
            for geom in np.unique(hits.geoms[near]).tolist():
                (again,) = np.nonzero(near & (hits.geoms == geom))
                found = self.cast(query.some(again, query.hidden | {geom}))
                hits.distances[again], hits.geoms[again] = found.distances, found.geoms
                near[again] = False
        return hits

    def _scene(self, hidden: frozenset[int]) -> TriangleScene | None:
        """Embree's scene without some geoms; None if it is empty."""
        if hidden not in self._scenes:
            geoms = self.geoms[~np.isin(self.geoms, list(hidden))] if hidden else self.geoms
            same = hidden and len(geoms) == len(self.geoms)
            self._scenes[hidden] = (
                self._scene(frozenset()) if same
                else TriangleScene(self._model, geoms, self._places) if len(geoms)
                else None
            )  # fmt: skip
        return self._scenes[hidden]
