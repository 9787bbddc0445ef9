"""Restitution by Newton's law of impact, which soft contacts cannot satisfy at any time step.

Bodies that meet faster than a surface's threshold get the rebound velocity, as in ODE. The impulse
is solved for all simultaneous contacts together, with Coulomb friction, against the inertia of all
bodies and joints. Other constraints, such as welds, react in the following steps.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import mujoco
import numpy as np

from cartwheel.geometry import Array
from cartwheel.world.contact import Bounce

_STEPS_OF_FALL = 2.0
"""Steps of free fall whose speed counts as resting, regardless of a surface's threshold."""
_SWEEPS = 200
"""Maximum iterations of the solver, because contacts of one body share its impulse."""
_SETTLED = 1e-9
"""Convergence tolerance for contact velocities, m/s."""
_SINGULAR = 1e-12
"""Minimum inverse mass; below it, a contact cannot move."""


class Bounces:
    """Impacts of a model's surfaces.

    Args:
        model: The MuJoCo model.
        surfaces: Surfaces with restitution.
    """

    def __init__(self, model: Any, surfaces: Sequence[Bounce]) -> None:
        self._restitution = np.zeros(model.ngeom)
        self._threshold = np.full(model.ngeom, np.inf)
        for each in surfaces:
            geom = model.geom(each.geom).id
            self._restitution[geom] = each.restitution
            self._threshold[geom] = each.threshold

    def apply(self, model: Any, data: Any, *, moved: bool = False) -> bool:
        """Applies restitution to the contacts in the current state.

        Args:
            model: The MuJoCo model.
            data: The MuJoCo data after a forward pass; positions and velocities may change.
            moved: Whether models that are fixed to the world move; see `Moved`.

        Returns:
            Whether anything changed; the forward pass must then be repeated.
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
        if moved:
            for axis in range(3):
                known = data.contact.dim[meeting] > (2 if axis else 0)
                rows = first[meeting[known]] + axis
                speeds[axis::3][known] = data.efc_vel[rows]
        wanted = np.zeros_like(speeds)
        wanted[::3] = -restitution[meeting] * speeds[::3]
        friction = data.contact.friction[meeting][:, :2]
        impulse = _impulse(jacobian @ response.T, speeds, wanted, friction)
        change = impulse[:, None] * response
        # The impact was within the last step, so the rebound velocity applies from then on.
        since = np.minimum(data.contact.dist[meeting] / speeds[::3], model.opt.timestep)
        shift = np.maximum(since, 0.0).repeat(3) @ change
        mujoco.mj_integratePos(model, data.qpos, shift, 1.0)
        data.qvel += change.sum(axis=0)
        return True


def _rows(model: Any, data: Any, index: int) -> Array:
    """Jacobian of the relative velocity at a contact, along its normal and both tangents."""
    contact = data.contact[index]
    jacobians = []
    for geom in contact.geom:
        found = np.zeros((3, model.nv))
        mujoco.mj_jac(model, data, found, None, contact.pos, int(model.geom_bodyid[geom]))
        jacobians.append(found)
    return np.asarray(contact.frame.reshape(3, 3) @ (jacobians[1] - jacobians[0]))


def _impulse(inverse_mass: Array, speeds: Array, wanted: Array, friction: Array) -> Array:
    """Solves for the impulses that produce the wanted velocities within the contact limits.

    Args:
        inverse_mass: Velocity of each row per impulse on each row, 1/kg.
        speeds: Velocities before the impact, m/s; normal and two tangents per contact.
        wanted: Velocities after the impact, m/s.
        friction: Friction coefficients along both tangents of each contact.

    Returns:
        Impulses, N s: normal impulses are nonnegative, tangential impulses are limited by friction.
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
