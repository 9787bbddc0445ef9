"""Rays from a link into the world, for laser scanners and sonars.

A sensor does not measure two groups of its own robot's shapes: shapes that enclose the sensor,
which are its enclosure, and shapes closer than the minimum range.
"""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np

from cartwheel.geometry import Array, Pose, matrix_from_quat
from cartwheel.simulation.sensing.embree_rays import EmbreeCaster, SharedRayScenes
from cartwheel.simulation.sensing.mujoco_rays import MujocoCaster
from cartwheel.simulation.sensing.ray_triangles import AVAILABLE
from cartwheel.simulation.sensing.visual_model import VisualModel
from cartwheel.world.bodies import COLLISION_GROUP
from cartwheel.world.entry import scoped
from cartwheel.world.visuals import VISUAL_GROUP

_WORTH_EMBREE = 64
"""Geoms; with fewer, MuJoCo is as fast, unless there are meshes."""
_FACES_PER_GEOM = 25
"""Triangles of meshes that take MuJoCo as long as a geom."""
_AXES = np.vstack([np.eye(3), -np.eye(3)])
_MESH = mujoco.mjtGeom.mjGEOM_MESH


class RayHandle:
    """A bundle of rays from one point on a link.

    The rays ignore geoms of the same model that enclose the point, such as the sensor's enclosure,
    and geoms of the same model nearer than `minimum`. They hit everything else.

    Args:
        model: Model name.
        link: Link name.
        pose: Pose of the sensor in the link.
        directions: Unit vectors in the sensor's axes, shape (n, 3).
        minimum: Minimum measured distance, m.
        maximum: Maximum measured distance, m; may be inf.
        scenes: What the rays of all sensors of a simulation share.
        visuals: Visuals to hit, as a GPU sensor does, instead of collisions.
    """

    _unsaved = frozenset(
        {
            "_model",
            "_data",
            "_body",
            "_place",
            "_turn",
            "_own",
            "_retros",
            "_reflects",
            "_caster",
        }
    )
    """Attributes that a saved state does not contain: they follow from the compiled model."""

    def __init__(
        self,
        model: str,
        link: str,
        pose: Pose,
        directions: Array,
        *,
        minimum: float,
        maximum: float,
        scenes: SharedRayScenes,
        visuals: VisualModel | None = None,
    ) -> None:
        self.model_name = model
        self.link_name = link
        self.minimum = minimum
        self.maximum = maximum
        self._offset = np.array(pose.position)
        self._directions = np.asarray(directions) @ matrix_from_quat(pose.orientation).T
        self._group = COLLISION_GROUP if visuals is None else VISUAL_GROUP
        self._shared, self._visuals = scenes, visuals
        self._model: Any = None
        self._enclosure: frozenset[int] | None = None

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
        self._place, self._turn = data.xpos[body], data.xmat[body].reshape(3, 3)
        prefix = scoped(self.model_name, "")
        own = np.array([model.body(i).name.startswith(prefix) for i in range(model.nbody)])
        # One more entry, for geom -1 of a ray without a hit.
        self._own = np.append(own[model.geom_bodyid], False)
        retros = model.geom_user[:, 0] if model.nuser_geom else np.zeros(model.ngeom)
        self._retros = np.append(retros, 0.0)
        self._reflects = bool(retros.any())
        # Determined at the first cast, because the new model has no computed poses yet.
        self._enclosure = None
        limits: dict[str, Any] = {"minimum": self.minimum, "maximum": self.maximum}
        self._caster: EmbreeCaster | MujocoCaster
        if AVAILABLE and _size(model, self._group) >= _WORTH_EMBREE:
            self._caster = EmbreeCaster(
                self._shared, model, data, group=self._group, body=body, own=self._own,
                offset=self._offset, directions=self._directions, **limits,
            )  # fmt: skip
        else:
            self._caster = MujocoCaster(
                model, data, group=self._group, own=self._own, directions=self._directions, **limits
            )

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
        turn = self._turn
        start = self._place + turn @ self._offset
        if self._enclosure is None:
            self._enclosure = self._enclosing(start)
        distances, geoms = self._caster.cast(start, turn, self._enclosure)
        far = distances >= self.maximum
        reflected = np.zeros(len(distances))
        if self._reflects:
            np.copyto(reflected, self._retros[geoms], where=~far)
        distances[distances <= self.minimum] = -np.inf
        distances[far] = np.inf
        return distances, reflected

    def _enclosing(self, start: Array) -> frozenset[int]:
        """Geoms that move with the sensor and contain its origin.

        From inside a convex shape, every ray hits it; from outside, two opposite rays cannot both
        hit it. For a mesh, the test finds walls on all sides.
        """
        model = self._model
        rigid = model.body_weldid[model.geom_bodyid] == model.body_weldid[self._body]
        seen = model.geom_group == self._group
        found = []
        for geom in np.flatnonzero(self._own[:-1] & rigid & seen).tolist():
            hits = (self._distance(geom, start, axis) for axis in _AXES)
            if all(hit >= 0 for hit in hits):
                found.append(geom)
        return frozenset(found)

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


def _size(model: Any, group: int) -> int:
    """Number of geoms, and what the meshes of a group count for."""
    meshes = model.geom_dataid[(model.geom_type == _MESH) & (model.geom_group == group)]
    return int(model.ngeom + model.mesh_facenum[meshes].sum() // _FACES_PER_GEOM)
