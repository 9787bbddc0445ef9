"""Occupied space, to place models next to each other."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from cartwheel.geometry import Array


@dataclass(frozen=True, kw_only=True, slots=True)
class Space:
    """Bounding boxes of the collision shapes in a world, aligned with the world's axes."""

    low: Array
    """Lowest corners, shape (n, 3), m."""
    high: Array
    """Highest corners, shape (n, 3), m."""
    fixed: Array
    """Which boxes never move, shape (n,)."""


def occupied(model: Any, data: Any) -> Space:
    """The space occupied by collision shapes, without infinite planes and height fields.

    Args:
        model: The compiled world.
        data: Its state.
    """
    mujoco.mj_kinematics(model, data)
    endless = (mujoco.mjtGeom.mjGEOM_PLANE, mujoco.mjtGeom.mjGEOM_HFIELD)
    solid = np.flatnonzero(
        ((model.geom_contype != 0) | (model.geom_conaffinity != 0))
        & ~np.isin(model.geom_type, endless)
    )
    boxes = model.geom_aabb[solid]
    turned = data.geom_xmat[solid].reshape(-1, 3, 3)
    middle = data.geom_xpos[solid] + np.einsum("nij,nj->ni", turned, boxes[:, :3])
    half = np.einsum("nij,nj->ni", np.abs(turned), boxes[:, 3:])
    fixed = model.body_weldid[model.geom_bodyid[solid]] == 0
    return Space(low=middle - half, high=middle + half, fixed=fixed)
