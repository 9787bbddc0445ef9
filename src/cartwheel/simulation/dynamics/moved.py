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
from cartwheel.simulation.dynamics.separation import DEEP

_TURNING = 0.02
"""rad/s; a body on a model that turns more slowly creeps less than a micrometre per second."""
_IMPACT = 0.02
"""s; an impact goes less deep than the speed in this time; see docs/physics.md, kp and kd."""
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
        owners: Ints = np.full(model.nbody, -1)
        for number, bodies in enumerate(roots):
            owners[np.isin(model.body_rootid, list(bodies))] = number
        self._owners = owners[model.geom_bodyid]
        self._bodies = np.flatnonzero(owners >= 0)
        self._of_bodies = owners[self._bodies]
        self._centres = model.body_rootid[self._bodies]
        self._linear, self._angular = (
            np.array([each[part] for each in velocities]).reshape(-1, 3) for part in (0, 1)
        )
        self._turns = bool((np.abs(self._angular) > _TURNING).any())
        fastest = float(np.linalg.norm(self._linear, axis=1).max(initial=0.0))
        self._deepest = DEEP + _IMPACT * fastest
        self.origins = np.zeros((len(roots), 3))
        """Positions of the models' frames now, m."""
        self._carried = Carried(model)

    def set_velocities(self, data: Any) -> None:
        """Gives the bodies their velocities, which MuJoCo has set to zero.

        Args:
            data: The MuJoCo data after its velocities were computed.
        """
        of = self._of_bodies
        # MuJoCo stores a body's velocity at the centre of mass of its kinematic tree.
        arms = data.subtree_com[self._centres] - self.origins[of]
        data.cvel[self._bodies, :3] = self._angular[of]
        data.cvel[self._bodies, 3:] = self._linear[of] + np.cross(self._angular[of], arms)

    def deep(self, data: Any) -> bool:
        """Whether one of the models is so deep in another one that it squeezes it.

        Args:
            data: The MuJoCo data after a forward pass.
        """
        if not data.ncon:
            return False
        owned = (self._owners[data.contact.geom] >= 0).any(axis=1)
        return bool((data.contact.dist[owned] < -self._deepest).any())

    def apply(self, model: Any, data: Any) -> None:
        """Completes a forward pass, with the velocities of the bodies and at the contacts.

        Args:
            model: The MuJoCo model.
            data: The MuJoCo data after a forward pass.
        """
        self.set_velocities(data)
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
