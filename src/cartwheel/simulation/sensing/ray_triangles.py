"""Triangles of shapes that move together, for Embree.

Embree finds the triangle that a ray hits, in single precision. The distance is then computed
exactly from the shape, in double precision: it does not depend on the triangles or on their order.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from cartwheel.geometry import Array
from cartwheel.simulation.sensing import ray_shapes as shapes
from cartwheel.simulation.sensing.ray_query import Hits

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
_MOST_STEPS = 64
"""Maximum number of triangles of curved shapes that a ray passes."""


class TriangleScene:
    """Triangles for Embree in the frame of a body, or in the world."""

    def __init__(self, model: Any, geoms: Any, places: Poses) -> None:
        self._model, self._places = model, places
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

    def find(self, start: Array, rays: Array) -> Any:
        """The triangles that rays hit, or -1.

        Args:
            start: Where each ray starts, shape (n, 3) or (3,), in the frame of the scene, m.
            rays: Unit vectors, shape (n, 3).
        """
        begin = np.empty(rays.shape, dtype=np.float32)
        begin[:] = start - self._centre
        return self._scene.run(begin, rays.astype(np.float32, order="C"))

    def cast(self, start: Array, rays: Array) -> Hits:
        """The nearest hits of rays in the frame of the scene; see `Query`."""
        found = self.find(start, rays)
        distances = self._to_triangles(start, rays, found)
        hits = Hits(distances, self._owners[found])
        if self._curved is not None:
            (which,) = np.nonzero(self._curved[found])
            if which.size:
                self._refine(start, rays, hits, which)
        return hits

    def _to_triangles(self, start: Array, rays: Array, triangles: Any) -> Array:
        """Distances to the planes of triangles."""
        x, y, z, heights = np.ascontiguousarray(self._planes.take(triangles, axis=0).T)
        across = np.zeros(len(rays))
        for part, origin, direction in zip((x, y, z), start.tolist(), rays.T, strict=True):
            heights -= part * origin
            across += part * direction
        with np.errstate(divide="ignore", invalid="ignore"):
            distances: Array = np.abs(heights / across)
        return distances

    def _refine(self, start: Array, rays: Array, hits: Hits, which: Any) -> None:
        """Replaces distances to the triangles of curved shapes by those to the shapes.

        A ray may pass between a curved surface and its triangles, and hit another shape.
        """
        surface, geoms = hits.distances[which], hits.geoms[which]
        hits.distances[which], hits.geoms[which] = np.inf, -1
        for _ in range(_MOST_STEPS):
            exact = self._exact(start, rays[which], geoms, surface)
            hits.add_some(which, Hits(exact, geoms))
            going = surface < hits.distances[which] - _CLOSE
            which, passed = which[going], surface[going] + _STEP
            if not which.size:
                return
            ray = rays[which]
            begins = start + passed[:, None] * ray
            found = self.find(begins, ray)
            some = found >= 0
            which, ray, found = which[some], ray[some], found[some]
            if not which.size:
                return
            # The plane of a triangle behind the start of the ray would be numerical noise.
            surface = np.maximum(self._to_triangles(start, ray, found), passed[some])
            geoms = self._owners[found]

    def _exact(self, start: Array, rays: Array, geoms: Any, surface: Array) -> Array:
        """Distances to curved shapes, inf for a miss, and otherwise those to the triangles."""
        here, turned = _into(self._places, geoms, start, rays)
        exact = surface.copy()
        kinds = self._model.geom_type[geoms]
        for kind in shapes.CURVED:
            (chosen,) = np.nonzero(kinds == kind)
            if chosen.size:
                sizes = self._model.geom_size[geoms[chosen]]
                exact[chosen] = shapes.TO_SHAPE[kind](here[chosen], turned[chosen], sizes)
        return exact


def _into(poses: Poses, geoms: Any, start: Array, rays: Array) -> tuple[Array, Array]:
    """Starts and directions in the frames of geoms, shape (n, 3) each."""
    turns = poses[1][geoms]
    here = np.einsum("ij,ijk->ik", start - poses[0][geoms], turns)
    return here, np.einsum("ij,ijk->ik", rays, turns)
