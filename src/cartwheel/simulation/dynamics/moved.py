"""Contacts with models that are fixed to the world and move at a velocity.

For MuJoCo, such a model is at rest in each step, so its contacts damp the velocity of the other
body relative to the world: the model would push with a force that depends on the step, and friction
would hold what lies on it. Here the velocity of its surface is added to that of each contact, so
that a contact has the same forces as if the other body moved instead. The same applies to the welds
of attached links, which would otherwise follow late.
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
_EQUALITY = mujoco.mjtConstraint.mjCNSTR_EQUALITY.value
_WELD = mujoco.mjtEq.mjEQ_WELD.value
_WELD_ROWS = 6
"""Constraints of a weld: three of the position, and three of the orientation."""
_BODY = mujoco.mjtObj.mjOBJ_BODY.value
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
        self._owners_of_bodies = owners
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
        pulled = self._pull(model, data)
        if self._push(model, data) or pulled:
            mujoco.mj_fwdConstraint(model, data)

    def _pull(self, model: Any, data: Any) -> bool:
        """Adds the velocities to the welds of attached links; returns whether there are any."""
        if not data.ne:
            return False
        bodies = np.stack([model.eq_obj1id, model.eq_obj2id])
        welds = (model.eq_type == _WELD) & (model.eq_objtype == _BODY) & (data.eq_active != 0)
        owners = np.where(welds, self._owners_of_bodies[np.where(welds, bodies, 0)], -1)
        found = np.flatnonzero((owners >= 0).any(axis=0))
        for weld in found.tolist():
            rows = np.flatnonzero((data.efc_type == _EQUALITY) & (data.efc_id == weld))
            if len(rows) != _WELD_ROWS:
                continue
            one, two = bodies[:, weld].tolist()
            values, bent = np.zeros(6), np.zeros(3)
            for body, owner, sign, arm in (
                (one, owners[0, weld], 1.0, model.eq_data[weld, 3:6]),
                (two, owners[1, weld], -1.0, model.eq_data[weld, :3]),
            ):
                if owner < 0:
                    continue
                place = data.xpos[body] + data.xmat[body].reshape(3, 3) @ arm
                spin = self._angular[owner]
                around = np.cross(spin, place - self.origins[owner])
                values[:3] += sign * (self._linear[owner] + around)
                values[3:] += sign * spin
                bent += sign * np.cross(spin, around)
            values[3:] = _turn(model, data, weld, values[3:])
            data.efc_vel[rows] += values
            data.efc_aref[rows] -= _damping(model, data, rows) * values
            data.efc_aref[rows[:3]] -= bent
        return bool(len(found))

    def _push(self, model: Any, data: Any) -> bool:
        """Adds the velocities to the contacts; returns whether there are any."""
        if not data.ncon:
            return False
        contacts = data.contact
        owners = self._owners[contacts.geom]
        rows = np.flatnonzero((owners >= 0).any(axis=1) & (contacts.efc_address >= 0))
        if not len(rows):
            return False
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
        return True


def _turn(model: Any, data: Any, weld: int, spin: Array) -> Array:
    """An angular velocity along the rows of a weld, as MuJoCo defines them for a rotation.

    They are half the vector part of q₂* ω q₁ p, times the scale of torques, where q₁ and q₂ are the
    orientations of the bodies, and p is their relative orientation.
    """
    target, inverse, product = np.zeros(4), np.zeros(4), np.zeros(4)
    mujoco.mju_mulQuat(target, data.xquat[model.eq_obj1id[weld]], model.eq_data[weld, 6:10])
    mujoco.mju_negQuat(inverse, data.xquat[model.eq_obj2id[weld]])
    mujoco.mju_mulQuat(product, np.array([0.0, *spin]), target)
    mujoco.mju_mulQuat(target, inverse, product)
    rows: Array = 0.5 * model.eq_data[weld, 10] * target[1:]
    return rows


def _damping(model: Any, data: Any, rows: Ints) -> Array:
    """Acceleration that a velocity along rows of constraints causes, 1/s.

    MuJoCo's discrete integrator applies the spring and the damper of a constraint at the end of the
    step, which reduces both.
    """
    stiffness, damping, impedance = data.efc_KBIP[rows, :3].T
    step, spring = model.opt.timestep, stiffness * impedance
    reduced: Array = (damping + step * spring) / (1 + step * damping + step * step * spring)
    return reduced
