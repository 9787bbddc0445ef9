"""Joints that follow other joints up to their own limits."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np

from cartwheel.world.mimics import CLAMPED

_JOINT = mujoco.mjtEq.mjEQ_JOINT.value


class Followers:
    """Limits the targets of followers whose leaders may leave the followers' limits.

    In Gazebo, a follower has a servo or a constraint of its own, so it stops at its limit and its
    leader moves on. The engine's constraint acts on both joints. Beyond a limit, it therefore holds
    the follower at the limit, without the leader. The target is a function of the positions alone,
    which nothing needs to save.

    Args:
        model: The compiled model.
    """

    def __init__(self, model: Any) -> None:
        marked = (model.eq_type == _JOINT) & (model.eq_data[:, CLAMPED.start] != 0.0)
        self._rows = np.flatnonzero(marked)
        self._joints = model.eq_obj1id[self._rows]
        self._leaders = model.jnt_qposadr[model.eq_obj2id[self._rows]]
        _, self._offsets, self._ratios = model.eq_data[self._rows, CLAMPED].T

    @property
    def any(self) -> bool:
        """Whether there are such joints."""
        return len(self._rows) > 0

    def apply(self, model: Any, data: Any) -> None:
        """Sets the targets for the current positions, before a forward pass."""
        targets = self._offsets + self._ratios * data.qpos[self._leaders]
        lower, upper = model.jnt_range[self._joints].T
        limited = model.jnt_limited[self._joints] != 0
        # Also at a limit, where leaders often start. False for positions that are not finite.
        held = limited & ((targets <= lower) | (targets >= upper))
        model.eq_data[self._rows, 0] = np.where(
            held, np.minimum(np.maximum(targets, lower), upper), self._offsets
        )
        model.eq_data[self._rows, 1] = np.where(held, 0.0, self._ratios)
