"""Stops a run that diverges, and says what most likely made it."""

from __future__ import annotations

import tempfile
from collections import deque
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from cartwheel.errors import SimulationError

_KEPT = 40
"""States, one for each check."""
_HUGE = 1e10
"""m, m/s or rad/s: what the engine itself takes for diverged."""
_WARNING = mujoco.mjtWarning
_UNSTABLE = {_WARNING.mjWARN_BADQPOS, _WARNING.mjWARN_BADQVEL, _WARNING.mjWARN_BADQACC}


def _swallow(message: str) -> None:
    """The engine's own report, which names no simulation; its counts in the data do."""


class Guard:
    """Watches one simulation's state and the engine's warnings, and keeps the last states.

    The engine would write its warnings to a file in the current folder and, left alone,
    quietly start a diverged simulation anew.
    """

    def __init__(self) -> None:
        mujoco.set_mju_user_warning(_swallow)
        self._states: deque[tuple[float, Any, Any]] = deque(maxlen=_KEPT)
        self._seen: dict[int, int] = {}

    def keep(self, data: Any) -> None:
        """Remembers a state for the dump."""
        self._states.append((data.time, data.qpos.copy(), data.qvel.copy()))

    def forget(self) -> None:
        """Drops what was kept: a new model has moved the indices, or time began anew."""
        self._states.clear()
        self._seen.clear()

    def check(self, model: Any, data: Any) -> list[str]:
        """Warnings that can be lived with, each once; none is the rule.

        Raises:
            SimulationError: The state is no longer finite.
        """
        # One number that is not finite spoils the sum: cheaper than a look at each.
        size = float(data.qpos.dot(data.qpos) + data.qvel.dot(data.qvel))
        if not size < _HUGE**2:
            raise self._diverged(model, data)
        if not data.warning.number.any():
            return []
        messages = []
        for kind in range(int(_WARNING.mjNWARNING)):
            count = int(data.warning[kind].number)
            if count and kind not in self._seen:
                if _WARNING(kind) in _UNSTABLE:
                    raise self._diverged(model, data)
                text = mujoco.mju_warningText(kind, int(data.warning[kind].lastinfo))
                messages.append(str(text).strip())
            self._seen[kind] = count
        return messages

    def _diverged(self, model: Any, data: Any) -> SimulationError:
        self.keep(data)
        with tempfile.NamedTemporaryFile(
            prefix="cartwheel-diverged-", suffix=".npz", delete=False
        ) as file:
            np.savez(
                file,
                time=np.array([state[0] for state in self._states]),
                qpos=np.array([state[1] for state in self._states]),
                qvel=np.array([state[2] for state in self._states]),
            )
        body = self._culprit(model, data)
        name = mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_BODY, body) or "world"
        return SimulationError(
            f'the simulation diverged by {data.time:.3f} s, first at "{name}"',
            hint=f"{_likely(model, body)} The last states are in {Path(file.name)}.",
        )

    def _culprit(self, model: Any, data: Any) -> int:
        """The body that moved fastest when all was still finite, of those that no longer are."""
        if not model.nv:
            return 0
        lost = ~np.isfinite(data.qvel) | (np.abs(data.qvel) >= _HUGE)
        speeds = next(
            (np.abs(qvel) for _, _, qvel in reversed(self._states) if np.isfinite(qvel).all()),
            np.zeros(model.nv),
        )
        dof = int(np.argmax(np.where(lost, speeds, -1.0) if lost.any() else speeds))
        return int(model.dof_bodyid[dof])


def _likely(model: Any, body: int) -> str:
    tree = [
        other
        for other in range(model.nbody)
        if model.body_rootid[other] == model.body_rootid[body] and model.body_mass[other] > 0
    ]
    if not body or not tree:
        return "A huge effort or speed does this most often."
    smallest = min(tree, key=lambda other: float(np.min(model.body_inertia[other])))
    name = mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_BODY, smallest)
    inertia, mass = float(np.min(model.body_inertia[smallest])), model.body_mass[smallest]
    return (
        f'The smallest moment of inertia of its model is that of "{name}", {inertia:.3g} kg m² at '
        f"{mass:.3g} kg: a value far too small for its size, or a huge effort or damping, does "
        "this most often."
    )
