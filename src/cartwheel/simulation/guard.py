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

_pending: list[str] = []


def _remember(message: str) -> None:
    _pending.append(message)


class Guard:
    """Watches the engine's warnings and keeps the last states.

    The engine would write its warnings to a file in the current folder and, left alone,
    quietly start a diverged simulation anew.
    """

    def __init__(self) -> None:
        mujoco.set_mju_user_warning(_remember)
        self._states: deque[tuple[float, Any, Any]] = deque(maxlen=_KEPT)

    def keep(self, data: Any) -> None:
        """Remembers a state for the dump."""
        self._states.append((data.time, data.qpos.copy(), data.qvel.copy()))

    def forget(self) -> None:
        """Drops the kept states, whose indices a new model has moved."""
        self._states.clear()

    def check(self, model: Any, data: Any) -> list[str]:
        """Warnings that can be lived with; none is the rule.

        Raises:
            SimulationError: The state is no longer finite.
        """
        if not _pending:
            return []
        messages = [message.strip() for message in _pending]
        _pending.clear()
        finite = np.isfinite(data.qpos).all() and np.isfinite(data.qvel).all()
        if finite and not any("unstable" in message for message in messages):
            return messages
        raise self._diverged(model, data)

    def _diverged(self, model: Any, data: Any) -> SimulationError:
        speeds = np.where(np.isfinite(data.qvel), np.abs(data.qvel), np.inf)
        dof = int(np.argmax(speeds)) if len(speeds) else 0
        body = int(model.dof_bodyid[dof]) if len(speeds) else 0
        name = mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_BODY, body) or "world"
        with tempfile.NamedTemporaryFile(
            prefix="cartwheel-diverged-", suffix=".npz", delete=False
        ) as file:
            np.savez(
                file,
                time=np.array([state[0] for state in self._states]),
                qpos=np.array([state[1] for state in self._states]),
                qvel=np.array([state[2] for state in self._states]),
            )
        mass = float(model.body_subtreemass[body])
        smallest = float(np.min(model.body_inertia[body]))
        likely = (
            f"Its smallest moment of inertia is {smallest:.3g} kg m² at {mass:.3g} kg: "
            "a value far too small for its size, or a huge effort or damping, does this most often."
        )
        return SimulationError(
            f'the simulation diverged at {data.time:.3f} s, first at "{name}"',
            hint=f"{likely} The last states are in {Path(file.name)}.",
        )
