"""The state that a newly compiled model takes from the one that it replaces."""

from __future__ import annotations

from typing import Any

import mujoco

_OBJ = mujoco.mjtObj
# Keyed by number: numpy integers equal the enum members, but hash differently.
STATE_SIZES = {mujoco.mjtJoint.mjJNT_FREE.value: (7, 6), mujoco.mjtJoint.mjJNT_BALL.value: (4, 3)}
"""Positions and velocities of joints that have several; others have one."""


def carry_over(old_model: Any, old: Any, model: Any, data: Any) -> None:
    """Copies the state of every joint that exists in both models, by name."""
    data.time = old.time
    for index in range(model.njnt):
        name = mujoco.mj_id2name(model, _OBJ.mjOBJ_JOINT, index)
        before = mujoco.mj_name2id(old_model, _OBJ.mjOBJ_JOINT, name)
        if before < 0 or model.jnt_type[index] != old_model.jnt_type[before]:
            continue
        positions, velocities = STATE_SIZES.get(int(model.jnt_type[index]), (1, 1))
        a, b = model.jnt_qposadr[index], old_model.jnt_qposadr[before]
        data.qpos[a : a + positions] = old.qpos[b : b + positions]
        a, b = model.jnt_dofadr[index], old_model.jnt_dofadr[before]
        for field in ("qvel", "qacc_warmstart"):
            getattr(data, field)[a : a + velocities] = getattr(old, field)[b : b + velocities]
