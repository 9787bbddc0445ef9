"""Stops a diverging simulation and reports the likely cause."""

from __future__ import annotations

import tempfile
from collections import deque
from collections.abc import Callable
from typing import Any

import mujoco
import numpy as np

from cartwheel.codes import world as world_codes
from cartwheel.errors import DivergedError, Origin

_KEPT = 40
"""Number of stored states, one per check."""
_DUMPS = 3
"""Maximum number of dump files per simulation, because divergence may recur without limit."""
_HUGE = 1e10
"""m, m/s or rad/s; the engine's own threshold for divergence."""
_WARNING = mujoco.mjtWarning
_UNSTABLE = {_WARNING.mjWARN_BADQPOS, _WARNING.mjWARN_BADQVEL, _WARNING.mjWARN_BADQACC}


def _swallow(message: str) -> None:
    """Discards the engine's log message, which has no simulation; the data contains the counts."""


class Guard:
    """Checks a simulation's state and the engine's warnings, and stores the last states.

    Without it, the engine writes warnings to a file in the current folder and silently resets a
    diverged simulation.
    """

    def __init__(self) -> None:
        mujoco.set_mju_user_warning(_swallow)
        self._states: deque[tuple[float, Any, Any]] = deque(maxlen=_KEPT)
        self._seen: dict[int, int] = {}
        self._dumps = 0

    def bind(self, model: Any, data: Any) -> None:
        """Continues with a new model, whose indices differ."""
        self._model, self._data = model, data
        self._qpos, self._qvel = data.qpos, data.qvel
        self._counts = data.warning.number
        self.forget()

    def _keep(self) -> None:
        """Stores the current state for the dump."""
        self._states.append((self._data.time, self._qpos.copy(), self._qvel.copy()))

    def save(self) -> tuple[Any, ...]:
        """The stored states and reported warnings, for `restore`."""
        return tuple(self._states), dict(self._seen)

    def restore(self, saved: tuple[Any, ...]) -> None:
        """Sets the stored states and reported warnings."""
        self.forget()
        self._states.extend(saved[0])
        self._seen.update(saved[1])

    def forget(self) -> None:
        """Discards the stored states after a time reset."""
        self._states.clear()
        self._seen.clear()

    def check(self, place_of: Callable[[str], Origin | None] = lambda _: None) -> list[str]:
        """Stores the state, and returns new engine warnings; usually none.

        Args:
            place_of: Returns the origin of a body's link. It is not stored, because it would keep
                its simulation alive.

        Raises:
            DivergedError: The state is no longer finite.
        """
        # A non-finite value makes the sum non-finite: cheaper than checking each value. Unlike
        # NumPy, MuJoCo does not warn of an overflow.
        size = mujoco.mju_dot(self._qpos, self._qpos) + mujoco.mju_dot(self._qvel, self._qvel)
        if not size < _HUGE**2:
            raise self._diverged(place_of)
        counts = self._counts.tolist()
        messages = self._messages(counts, place_of) if any(counts) else []
        self._keep()
        return messages

    def _messages(self, counts: list[int], place_of: Callable[[str], Origin | None]) -> list[str]:
        """The messages of engine warnings that are new."""
        messages = []
        for kind, count in enumerate(counts):
            if count and kind not in self._seen:
                if _WARNING(kind) in _UNSTABLE:
                    raise self._diverged(place_of)
                text = mujoco.mju_warningText(kind, int(self._data.warning[kind].lastinfo))
                messages.append(str(text).strip())
            self._seen[kind] = count
        return messages

    def _diverged(self, place_of: Callable[[str], Origin | None]) -> DivergedError:
        self._keep()
        if self._dumps >= _DUMPS:
            return self._error("", place_of)
        self._dumps += 1
        with tempfile.NamedTemporaryFile(
            prefix="cartwheel-diverged-", suffix=".npz", delete=False
        ) as file:
            np.savez(
                file,
                time=np.array([state[0] for state in self._states]),
                qpos=np.array([state[1] for state in self._states]),
                qvel=np.array([state[2] for state in self._states]),
            )
        return self._error(file.name, place_of)

    def _error(self, states: str, place_of: Callable[[str], Origin | None]) -> DivergedError:
        """The error, with the file of the last states if it was written."""
        body = self._culprit()
        name = mujoco.mj_id2name(self._model, mujoco.mjtObj.mjOBJ_BODY, body) or "world"
        smallest = _smallest(self._model, body)
        return DivergedError(
            f'the simulation diverged at {self._data.time:.3f} s, first at "{name}"',
            code=world_codes.SIMULATION_DIVERGED,
            values={
                "body": name,
                "time": float(self._data.time),
                "states": states,
                "inertia": _inertia(self._model, smallest),
            },
            origin=place_of(name),
            hint=_likely(self._model, smallest)
            + (f" The last states were saved to {states}." if states else ""),
        )

    def _culprit(self) -> int:
        """Of the bodies that are no longer finite, the fastest one in the last finite state."""
        model, data = self._model, self._data
        if not model.nv:
            return 0
        lost = ~np.isfinite(data.qvel) | (np.abs(data.qvel) >= _HUGE)
        speeds = next(
            (np.abs(qvel) for _, _, qvel in reversed(self._states) if np.isfinite(qvel).all()),
            np.zeros(model.nv),
        )
        dof = int(np.argmax(np.where(lost, speeds, -1.0) if lost.any() else speeds))
        return int(model.dof_bodyid[dof])


def _smallest(model: Any, body: int) -> int:
    """The body with the smallest moment of inertia in the model of a body; 0 for the world."""
    tree = [
        other
        for other in range(model.nbody)
        if model.body_rootid[other] == model.body_rootid[body] and model.body_mass[other] > 0
    ]
    if not body or not tree:
        return 0
    return min(tree, key=lambda other: _inertia(model, other))


def _inertia(model: Any, body: int) -> float:
    """The smallest principal moment of inertia of a body, kg m²."""
    return float(np.min(model.body_inertia[body]))


def _likely(model: Any, body: int) -> str:
    if not body:
        return "The most common cause is a very large effort or speed."
    name = mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_BODY, body)
    return (
        f"The smallest moment of inertia in the model is {_inertia(model, body):.3g} kg m² (link "
        f'"{name}", {model.body_mass[body]:.3g} kg). The most common causes are an inertia that is '
        "far too small for the size of the link, and a very large effort or damping."
    )
