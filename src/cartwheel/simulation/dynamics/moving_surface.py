"""Collisions whose surface moves along itself, such as tracks of vehicles and conveyor belts."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import mujoco
import numpy as np

from cartwheel.geometry import Array
from cartwheel.world.entry import scoped

_OBJ = mujoco.mjtObj
_AXES = {
    mujoco.mjtGeom.mjGEOM_SPHERE.value: 0.0,
    mujoco.mjtGeom.mjGEOM_CYLINDER.value: 1.0,
    mujoco.mjtGeom.mjGEOM_CAPSULE.value: 1.0,
}
"""Length of the axis of each round shape; 0 if it is round about each axis."""


class SurfaceContacts(NamedTuple):
    """The contacts of one collision, after a forward pass."""

    centre: Array
    """Origin of the collision in the world, shape (3,), m."""
    size: float
    """Largest distance of a point from it, m."""
    radius: float
    """Radius of a sphere, cylinder or capsule, m; 0 for other shapes."""
    axis: Array
    """Its axis in the world, shape (3,); zero for a sphere."""
    positions: Array
    """Shape (n, 3), m."""
    normals: Array
    """Unit normals that point into the collision, shape (n, 3)."""


class SurfaceHandle:
    """The surfaces of a link's collisions.

    The engine adds the velocity of a surface to that of its body where it computes friction. It has
    the field of a rigid motion in the axes of each geom, of which contacts use the part along the
    surface. Source: MuJoCo's documentation, ``geom/surfacevel``.

    Args:
        model: Model name.
        link: Link name.
    """

    def __init__(self, model: str, link: str) -> None:
        self.model_name = model
        self.name = link
        self._geoms: list[int] = []

    def bind(self, model: Any, data: Any) -> None:
        """Resolves the name in a compiled model."""
        self._model, self._data = model, data
        body = mujoco.mj_name2id(model, _OBJ.mjOBJ_BODY, scoped(self.model_name, self.name))
        self._geoms = np.flatnonzero(
            (model.geom_bodyid == body) & ((model.geom_contype | model.geom_conaffinity) != 0)
        ).tolist()
        kinds = {geom: int(model.geom_type[geom]) for geom in self._geoms}
        self._round = {geom: _AXES[kind] for geom, kind in kinds.items() if kind in _AXES}
        self.fixed = int(model.body_weldid[body]) == 0
        """Whether the link cannot move, as that of a conveyor belt."""
        # The compiler clears it if no surface moves.
        model.flg_surfacevel = True

    @property
    def count(self) -> int:
        """Number of the link's collisions."""
        return len(self._geoms)

    def stop(self) -> None:
        """Stops the surfaces; none move before the model is compiled."""
        if not self._geoms:
            return
        self._model.geom_surfacevel[self._geoms] = 0.0

    def contacts(self) -> list[SurfaceContacts]:
        """Returns the contacts of each collision, after a forward pass."""
        data = self._data
        pairs = data.contact.geom
        active = data.contact.efc_address >= 0
        found = []
        for geom in self._geoms:
            first, second = (pairs[:, side] == geom for side in (0, 1))
            rows = np.flatnonzero((first | second) & active)
            # The normal points from the first geom to the second.
            signs = np.where(second[rows], 1.0, -1.0)[:, None]
            found.append(
                SurfaceContacts(
                    centre=data.geom_xpos[geom].copy(),
                    size=float(self._model.geom_rbound[geom]),
                    radius=float(self._model.geom_size[geom, 0]) if geom in self._round else 0.0,
                    axis=self._round.get(geom, 0.0) * data.geom_xmat[geom, 2::3],
                    positions=data.contact.pos[rows],
                    normals=signs * data.contact.frame[rows, :3],
                )
            )
        return found

    def local(self, number: int, linear: Array, angular: Array) -> list[float]:
        """Converts a motion to the axes of a collision.

        Args:
            number: The collision, in the order of `contacts`.
            linear: Velocity at its origin relative to the link, in world axes, m/s, shape (3,).
            angular: Angular velocity of the field in world axes, rad/s, shape (3,).

        Returns:
            Both velocities, for `move`.
        """
        axes = self._data.geom_xmat[self._geoms[number]].reshape(3, 3)
        return [*(linear @ axes).tolist(), *(angular @ axes).tolist()]

    def move(self, motions: Sequence[Sequence[float]]) -> None:
        """Moves the surfaces. It must be called before a step's forward pass.

        Args:
            motions: For each collision, both velocities in its axes, m/s and rad/s; see `local`.
        """
        if len(motions) == len(self._geoms):
            self._model.geom_surfacevel[self._geoms] = motions
