"""Wheels with slip proportional to the transmitted force."""

from __future__ import annotations

import math
from typing import Any

import mujoco

from cartwheel.world.entry import SHIFT, TURN, TYRE, scoped

_OBJ = mujoco.mjtObj
_RIGID = 1e7
"""N s/m; damping of a wheel without slip."""


class SlipHandle:
    """A wheel's tyre, which rotates and shifts relative to the wheel, each with a damper.

    Within the friction limit, the tyre does not slide on the ground, so all slip occurs between
    wheel and tyre. ODE's slip compliance of c (speed per force) corresponds to a damping of 1 / c.
    The engine integrates it implicitly, so it is stable for any c.

    Args:
        model: Model name.
        link: Link name of the wheel.
        radius: Wheel radius, m.
    """

    def __init__(self, model: str, link: str, radius: float) -> None:
        self.model_name = model
        self.name = link
        self.radius = radius

    def bind(self, model: Any, data: Any) -> None:
        """Resolves the names in a compiled model."""
        tyre = scoped(self.model_name, self.name, TYRE)
        self._damping, self._qpos, self._qvel = model.dof_damping, data.qpos, data.qvel
        ids = [
            mujoco.mj_name2id(model, _OBJ.mjOBJ_JOINT, scoped(tyre, what)) for what in (TURN, SHIFT)
        ]
        self._turn, self._shift = (int(model.jnt_dofadr[joint]) for joint in ids)
        self._place = int(model.jnt_qposadr[ids[1]])
        self.give(0.0, 0.0)

    def give(self, lateral: float, longitudinal: float) -> None:
        """Sets the slip compliance, m/s/N; 0 disables slip. Call it at every step."""
        damping = self._damping
        damping[self._turn] = self.radius**2 * min(_RIGID, 1.0 / max(longitudinal, 1.0 / _RIGID))
        damping[self._shift] = min(_RIGID, 1.0 / max(lateral, 1.0 / _RIGID))
        # Reset the tyre's displacement, which is slip that has already occurred.
        self._qpos[self._place] = 0.0
        self._qpos[self._place - 1] = math.remainder(self._qpos[self._place - 1], 2 * math.pi)

    @property
    def speeds(self) -> tuple[float, float]:
        """Slip velocities of the rim relative to the ground: along the axle, and forward, m/s."""
        return -float(self._qvel[self._shift]), -float(self._qvel[self._turn]) * self.radius
