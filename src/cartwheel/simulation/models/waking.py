"""Keeps bodies awake whose surroundings change."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

import mujoco
import numpy as np

from cartwheel.simulation.engine import Engine

_AWAKE = -(1 + mujoco.mjMINAWAKE)
"""`MjData.tree_asleep` of a tree that moves. It increases by one in each step at rest, and at -1
the tree falls asleep.
"""


def wake_all(engine: Engine) -> None:
    """Wakes all bodies, because what keeps them at rest may have changed."""
    # MuJoCo wakes trees that are marked as both awake and asleep.
    engine.data.tree_awake[:] = 1
    _restart_counts(engine.data, slice(None))


def keep_awake(engine: Engine, joints: Collection[int]) -> None:
    """Keeps the bodies of joints awake, and those in contact with them.

    Call it before the joints are moved. MuJoCo itself wakes bodies that are asleep.
    """
    data, model = engine.data, engine.model
    moved = np.zeros(len(data.tree_asleep), dtype=bool)
    moved[model.dof_treeid[model.jnt_dofadr[list(joints)]]] = True
    counts = data.tree_asleep[~moved]
    if ((counts > _AWAKE) & (counts < 0)).any():
        # So that the contacts do not depend on who has read data since the last step.
        engine.refresh()
        islands = data.tree_island
        moved |= (islands >= 0) & np.isin(islands, islands[moved])
    _restart_counts(data, moved)


def _restart_counts(data: Any, trees: Any) -> None:
    """Counts the steps at rest of awake trees anew.

    MuJoCo counts them by the velocities before each step. A body that was moved into the air is
    still at rest then, and could fall asleep there.
    """
    counts = data.tree_asleep
    counts[trees] = np.where(counts[trees] < 0, _AWAKE, counts[trees])
