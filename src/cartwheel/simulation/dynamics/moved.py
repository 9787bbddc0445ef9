"""Contacts with models that are fixed to the world and move at a velocity.

For MuJoCo, such a model is at rest in each step, so its contacts damp the velocity of the other
body relative to the world: the model would push with a force that depends on the step, and friction
would hold what lies on it. Here the velocity of its surface is added to that of each contact, so
that a contact has the same forces as if the other body moved instead.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from cartwheel.geometry import Array, Vec3
from cartwheel.simulation.dynamics.carried import Carried

_TURNING = 0.02
"""rad/s; a body on a model that turns more slowly creeps less than a micrometre per second."""
_TORSION = 4
"""Dimensions of a contact with torsional friction; see MuJoCo's ``condim``."""
_ROLLING = 6
Ints = NDArray[np.int64]


class Moved:
    """The shapes of models that move at a velocity.

    Args:
        model: The MuJoCo model.
        roots: For each of these models, its bodies that are fixed to the world.
        velocities: For each, the linear velocity of its frame, m/s, and the angular one, rad/s.
    """

    def __init__(
        self, model: Any, roots: Sequence[Sequence[int]], velocities: Sequence[tuple[Vec3, Vec3]]
    ) -> None:
        self._owners: Ints = np.full(model.ngeom, -1)
        for number, bodies in enumerate(roots):
            mine = np.isin(model.body_rootid[model.geom_bodyid], list(bodies))
            self._owners[mine] = number
        self._linear, self._angular = (
            np.array([each[part] for each in velocities]).reshape(-1, 3) for part in (0, 1)
        )
        self._turns = bool((np.abs(self._angular) > _TURNING).any())
        self.origins = np.zeros((len(roots), 3))
        """Positions of the models' frames now, m."""
        self._carried = Carried(model)

    def apply(self, model: Any, data: Any) -> None:
        """Solves a forward pass again, with the velocities at the contacts.

        Args:
            model: The MuJoCo model.
            data: The MuJoCo data after a forward pass.
        """
        if not data.ncon:
            return
        contacts = data.contact
        owners = self._owners[contacts.geom]
        rows = np.flatnonzero((owners >= 0).any(axis=1) & (contacts.efc_address >= 0))
        if not len(rows):
            return
        owners, first = owners[rows], contacts.efc_address[rows]
        points, sizes = contacts.pos[rows], contacts.dim[rows]
        frames = contacts.frame[rows].reshape(-1, 3, 3)
        linear, angular, bent = (np.zeros((len(rows), 3)) for _ in range(3))
        for side, sign in ((0, -1.0), (1, 1.0)):
            mine = owners[:, side] >= 0
            of = owners[mine, side]
            arms, spin = points[mine] - self.origins[of], self._angular[of]
            around = np.cross(spin, arms)
            linear[mine] += sign * (self._linear[of] + around)
            angular[mine] += sign * spin
            if self._turns:
                bent[mine] += sign * np.cross(spin, around)
                bodies = model.geom_bodyid[contacts.geom[rows[~mine], side]]
                bent[~mine] += sign * self._carried.bias(model, data, bodies, points[~mine])
        along = np.einsum("ijk,ik->ij", frames, linear)
        about = np.einsum("ijk,ik->ij", frames, angular)
        for row, (least, values) in enumerate(
            (
                *((1 if axis == 0 else 3, along[:, axis]) for axis in range(3)),
                *((_TORSION if axis == 0 else _ROLLING, about[:, axis]) for axis in range(3)),
            )
        ):
            used = sizes >= least
            places = first[used] + row
            data.efc_vel[places] += values[used]
            data.efc_aref[places] -= _damping(model, data, places) * values[used]
        if self._turns:
            tangents = np.einsum("ijk,ik->ij", frames, bent)[:, 1:]
            self._carried.bend(model, data, first[sizes >= 3], tangents[sizes >= 3])
        mujoco.mj_fwdConstraint(model, data)


def _damping(model: Any, data: Any, rows: Ints) -> Array:
    """Acceleration that a velocity along rows of contacts causes, 1/s.

    MuJoCo's discrete integrator applies the spring and the damper of a contact at the end of the
    step, which reduces both.
    """
    stiffness, damping, impedance = data.efc_KBIP[rows, :3].T
    step, spring = model.opt.timestep, stiffness * impedance
    reduced: Array = (damping + step * spring) / (1 + step * damping + step * step * spring)
    return reduced
