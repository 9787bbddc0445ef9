"""Bodies that bounce: Newton's law of impact, which a soft contact cannot keep at any step.

What meets faster than a surface's threshold is given the velocity with which it parts, as ODE
does. The impulse is that of all contacts of the moment together, with Coulomb's friction, against
the inertia of all bodies and joints; what holds bodies otherwise, such as a weld, answers in the
steps after it.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import mujoco
import numpy as np

from cartwheel.geometry import Array
from cartwheel.world.contact import Bounce

_STEPS_OF_FALL = 2.0
"""What gravity gives in so many steps is a body that rests, whatever a surface's threshold."""
_SWEEPS = 200
"""Of the solver, at most: contacts of one body share its impulse."""
_SETTLED = 1e-9
"""m/s, by which no contact's velocity is changed any more."""
_SINGULAR = 1e-12
"""Of an inverse mass: a contact that nothing can move."""


class Bounces:
    """The impacts of one model's surfaces.

    Args:
        model: MuJoCo's.
        surfaces: Those that bounce.
    """

    def __init__(self, model: Any, surfaces: Sequence[Bounce]) -> None:
        self._restitution = np.zeros(model.ngeom)
        self._threshold = np.full(model.ngeom, np.inf)
        for each in surfaces:
            geom = model.geom(each.geom).id
            self._restitution[geom] = each.restitution
            self._threshold[geom] = each.threshold

    def apply(self, model: Any, data: Any) -> bool:
        """Throws back what meets in the present state.

        Args:
            model: MuJoCo's.
            data: After a forward pass; positions and velocities may change.

        Returns:
            Whether anything was: the pass must be made anew.
        """
        if data.ncon == 0:
            return False
        geoms, first = data.contact.geom, data.contact.efc_address
        restitution = self._restitution[geoms].min(axis=1)
        slowest = _STEPS_OF_FALL * float(np.linalg.norm(model.opt.gravity)) * model.opt.timestep
        threshold = np.maximum(self._threshold[geoms].min(axis=1), slowest)
        able = np.flatnonzero((restitution > 0) & (first >= 0))
        meeting = able[-data.efc_vel[first[able]] > threshold[able]]
        if not len(meeting):
            return False
        jacobian = np.vstack([_rows(model, data, int(index)) for index in meeting])
        response = np.zeros_like(jacobian)
        mujoco.mj_solveM(model, data, response, jacobian)
        speeds = jacobian @ data.qvel
        wanted = np.zeros_like(speeds)
        wanted[::3] = -restitution[meeting] * speeds[::3]
        friction = data.contact.friction[meeting][:, :2]
        impulse = _impulse(jacobian @ response.T, speeds, wanted, friction)
        change = impulse[:, None] * response
        # It met within the last step: what it is thrown by moves it from then on.
        since = np.minimum(data.contact.dist[meeting] / speeds[::3], model.opt.timestep)
        shift = np.maximum(since, 0.0).repeat(3) @ change
        mujoco.mj_integratePos(model, data.qpos, shift, 1.0)
        data.qvel += change.sum(axis=0)
        return True


def _rows(model: Any, data: Any, index: int) -> Array:
    """How fast two bodies part at a contact, along its normal and both tangents, by `qvel`."""
    contact = data.contact[index]
    jacobians = []
    for geom in contact.geom:
        found = np.zeros((3, model.nv))
        mujoco.mj_jac(model, data, found, None, contact.pos, int(model.geom_bodyid[geom]))
        jacobians.append(found)
    return np.asarray(contact.frame.reshape(3, 3) @ (jacobians[1] - jacobians[0]))


def _impulse(inverse_mass: Array, speeds: Array, wanted: Array, friction: Array) -> Array:
    """The impulses that bring speeds to those that are wanted, within what contacts can bear.

    Args:
        inverse_mass: Speed of each row by the impulse on each, 1/kg.
        speeds: m/s before, for each contact along the normal and both tangents.
        wanted: m/s after.
        friction: Of each contact, along both tangents.

    Returns:
        N s: along a normal not below 0, across it no more than friction bears.
    """
    impulse = np.zeros_like(speeds)
    diagonal = np.maximum(np.diag(inverse_mass), _SINGULAR)
    for _ in range(_SWEEPS):
        before = impulse.copy()
        for row in range(len(speeds)):
            error = wanted[row] - speeds[row] - inverse_mass[row] @ impulse
            value = impulse[row] + error / diagonal[row]
            contact, direction = divmod(row, 3)
            if direction == 0:
                impulse[row] = max(value, 0.0)
            else:
                most = friction[contact, direction - 1] * impulse[3 * contact]
                impulse[row] = min(max(value, -most), most)
        if np.abs(inverse_mass @ (impulse - before)).max() < _SETTLED:
            break
    return impulse
