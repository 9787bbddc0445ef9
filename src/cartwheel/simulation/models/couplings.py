"""Joints whose positions follow those of other joints."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import mujoco

from cartwheel.geometry import Array
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
    return [
        Coupling(
            follower=names[follower],
            leader=names[leader],
            ratio=ratio,
            offset=offset,
        )
        for kind, follower, leader, values, active in zip(
            model.eq_type.tolist(),
            model.eq_obj1id.tolist(),
            model.eq_obj2id.tolist(),
            model.eq_data,
            data.eq_active.tolist(),
            strict=True,
        )
        for offset, ratio in [_stated(values)]
        if kind == mujoco.mjtEq.mjEQ_JOINT and active and follower in names and leader in names
    ]


def _stated(values: Array) -> tuple[float, float]:
    """Offset and ratio of a constraint, also while a limit of the follower replaces its target."""
    marked, offset, ratio = values[CLAMPED].tolist()
    return (offset, ratio) if marked else (float(values[0]), float(values[1]))
