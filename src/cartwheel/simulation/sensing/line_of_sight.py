"""Line-of-sight tests, to choose views of a model."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import mujoco
import numpy as np

from cartwheel.geometry import Vec3
from cartwheel.world.entry import scoped
from cartwheel.world.visuals import VISUAL_GROUP

_GROUPS = np.zeros(mujoco.mjNGROUP, dtype=np.uint8)
_GROUPS[VISUAL_GROUP] = 1


def in_sight(model: Any, data: Any, name: str, eyes: Sequence[Vec3], target: Vec3) -> list[bool]:
    """For each viewpoint, whether only the model's own visuals lie between it and the target.

    Args:
        model: The compiled world.
        data: Its state after a forward pass.
        name: The model whose visuals do not block the view.
        eyes: Viewpoints in the world, m.
        target: Target point in the world, m.
    """
    own = scoped(name, "")
    hit = np.zeros(1, dtype=np.int32)
    clear = []
    for eye in eyes:
        way = np.subtract(target, eye)
        length = float(np.linalg.norm(way))
        distance = mujoco.mj_ray(model, data, eye, way / length, _GROUPS, 1, -1, hit, None)
        body = int(model.geom_bodyid[hit[0]]) if hit[0] >= 0 else 0
        clear.append(not 0 <= distance < length or model.body(body).name.startswith(own))
    return clear
