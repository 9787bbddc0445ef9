"""Joints that follow other joints up to their own limits."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from cartwheel.world.joints import reversed_coupling, reverses
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
        self._each = [_Follower(model, row) for row in np.flatnonzero(marked).tolist()]

    @property
    def any(self) -> bool:
        """Whether there are such joints."""
        return len(self._each) > 0

    def apply(self, data: Any) -> None:
        """Sets the targets for the current positions, before a forward pass."""
        positions = data.qpos
        for each in self._each:
            each.aim(positions)


@dataclass(frozen=True, slots=True)
class _Constraint:
    """How a constraint is written: position of `first` = offset + ratio * position of `second`."""

    first: int
    second: int
    ratio: float
    offset: float


class _Follower:
    """A follower; see `Followers`.

    Args:
        model: The compiled model.
        row: The index of its constraint.
    """

    __slots__ = (
        "_first",
        "_follower",
        "_following",
        "_leader",
        "_limited",
        "_offset",
        "_position",
        "_range",
        "_ratio",
        "_second",
        "_values",
    )

    def __init__(self, model: Any, row: int) -> None:
        # All arrays are views of the model.
        self._values = model.eq_data[row]
        self._first = model.eq_obj1id[row : row + 1]
        self._second = model.eq_obj2id[row : row + 1]
        mark, self._offset, self._ratio = self._values[CLAMPED].tolist()
        joints = int(self._first[0]), int(self._second[0])
        follower, leader = joints if mark > 0 else joints[::-1]
        self._follower, self._leader = follower, leader
        self._position = int(model.jnt_qposadr[leader])
        self._limited = model.jnt_limited[follower : follower + 1]
        self._range = model.jnt_range[follower]
        self._following = _Constraint(follower, leader, self._ratio, self._offset)
        if reverses(self._ratio):
            reverse = reversed_coupling(self._ratio, self._offset)
            self._following = _Constraint(leader, follower, *reverse)

    def aim(self, positions: Any) -> None:
        """Sets the target for these positions of all joints."""
        target = self._offset + self._ratio * float(positions[self._position])
        lower, upper = self._range.tolist() if self._limited[0] else (-math.inf, math.inf)
        wanted = self._following
        # Also at a limit, where leaders often start. False for positions that are not finite.
        if target <= lower or target >= upper:
            end = min(max(target, lower), upper)
            wanted = _Constraint(self._follower, self._leader, 0.0, end)
        offset, ratio, *_ = self._values.tolist()
        # Mostly, nothing has changed. A restored model may contain other values than the last ones.
        if ratio != wanted.ratio or offset != wanted.offset:
            self._values[:2] = wanted.offset, wanted.ratio
            self._values[CLAMPED.start] = 1.0 if wanted.first == self._follower else -1.0
            self._first[0], self._second[0] = wanted.first, wanted.second
