"""Joints whose positions follow those of other joints."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import mujoco

from cartwheel.world.mimics import CLAMPED


@dataclass(frozen=True, kw_only=True, slots=True)
class Coupling:
    """A joint whose position is ratio * position of another joint + offset."""

    follower: str
    leader: str
    ratio: float
    offset: float
    """rad or m."""


def couplings(
    model: mujoco.MjModel, data: mujoco.MjData, names: Mapping[int, str]
) -> list[Coupling]:
    """The active couplings between joints, from ``<mimic>`` tags and plugins.

    Args:
        model: The compiled model.
        data: Its state.
        names: The joints that count: names by the engine's index.
    """
    found = []
    for kind, first, second, values, active in zip(
        model.eq_type.tolist(),
        model.eq_obj1id.tolist(),
        model.eq_obj2id.tolist(),
        model.eq_data,
        data.eq_active.tolist(),
        strict=True,
    ):
        if kind != mujoco.mjtEq.mjEQ_JOINT or not active:
            continue
        offset, ratio = values[:2].tolist()
        follower, leader = first, second
        mark, stated_offset, stated_ratio = values[CLAMPED].tolist()
        if mark:
            # A limit of the follower may replace its target.
            offset, ratio = stated_offset, stated_ratio
        if mark < 0:
            follower, leader = second, first
        if follower in names and leader in names:
            found.append(
                Coupling(follower=names[follower], leader=names[leader], ratio=ratio, offset=offset)
            )
    return found
