"""Wheels that slip in proportion to the force that they pass on."""

from __future__ import annotations

import math
from typing import Any

import mujoco

from cartwheel.world.entry import SHIFT, TURN, TYRE, scoped

_OBJ = mujoco.mjtObj
_RIGID = 1e7
"""N s/m, of a wheel that does not slip."""


class SlipHandle:
    """A wheel's tyre, which lags behind the wheel and shifts along its axle as a damper does.

    Within the friction that it has, the tyre does not slip on the ground: what the wheel slips, it
    slips on the tyre. A speed of slip of c for each N, as ODE's contacts have it, is a damper of
    1 / c; the engine takes it implicitly, so that any c is stable.

    Args:
        model: Name of the model.
        link: The wheel.
        radius: Of the wheel, m.
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
        """Sets how fast it slips for each N, m/s/N; 0 is not at all. Call it at every step."""
        damping = self._damping
        damping[self._turn] = self.radius**2 * min(_RIGID, 1.0 / max(longitudinal, 1.0 / _RIGID))
        damping[self._shift] = min(_RIGID, 1.0 / max(lateral, 1.0 / _RIGID))
        # A tyre does not leave its wheel: what it has shifted, the wheel has slipped.
        self._qpos[self._place] = 0.0
        self._qpos[self._place - 1] = math.remainder(self._qpos[self._place - 1], 2 * math.pi)

    @property
    def speeds(self) -> tuple[float, float]:
        """Of the wheel's rim on the ground: along the axle, and ahead of the ground, m/s."""
        return -float(self._qvel[self._shift]), -float(self._qvel[self._turn]) * self.radius
