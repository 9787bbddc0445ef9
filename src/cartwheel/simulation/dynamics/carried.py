"""Contacts between bodies that turn together, such as a box on a turntable or in a gripper.

MuJoCo demands that the acceleration between two surfaces that do not slide is J q̈ = 0, with the
contact's Jacobian J. But the velocity J q̇ remains zero only with J q̈ + J̇ q̇ = 0. The missing term
contains the centripetal acceleration of the bodies: without it, a box creeps off a turntable at a
speed of the centripetal acceleration times half the contact's time constant. Here it is added along
the surface. Across it, the term depends on how the surfaces are curved, and is left out.
"""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from cartwheel.geometry import Array

LOOK = 8
"""Steps between two searches for such contacts."""
_TURNING = 0.02
"""rad/s; bodies that turn more slowly creep less than a micrometre per second."""
_FREE = mujoco.mjtJoint.mjJNT_FREE.value
_HINGE = mujoco.mjtJoint.mjJNT_HINGE.value
Ints = NDArray[np.int64]


class Carried:
    """The contacts of a model between movable bodies of different kinematic trees.

    Args:
        model: The MuJoCo model.
    """

    def __init__(self, model: Any) -> None:
        self._bodies: list[int] = model.geom_bodyid.tolist()
        trees = model.body_treeid[model.geom_bodyid]
        self._trees: list[int] = trees.tolist()
        solid = (model.geom_contype | model.geom_conaffinity) != 0
        self.possible = len(set(trees[solid & (trees >= 0)].tolist())) > 1
        """Whether there are two trees that can touch each other."""
        self._dots = np.zeros((3, model.nv))
        roots = model.body_weldid
        self._joints = model.body_jntadr[roots]
        """The joint of each body that is part of a body with one joint to the world."""
        kinds = model.jnt_type[self._joints] if model.njnt else roots
        single = (model.body_jntnum[roots] == 1) & (
            model.body_weldid[model.body_parentid[roots]] == 0
        )
        self._alone = single & np.isin(kinds, (_FREE, _HINGE))
        """Whether a body can only move freely, or about a fixed axis."""

    def any_turn(self, data: Any) -> bool:
        """Whether there are such contacts, one of whose bodies turns.

        Args:
            data: The MuJoCo data after a forward pass or a step.
        """
        pairs = self._pairs(data)
        if not pairs:
            return False
        bodies = np.array(pairs)[:, 1:]
        return bool((np.abs(data.cvel[bodies, :3]) > _TURNING).any())

    def apply(self, model: Any, data: Any) -> None:
        """Solves a forward pass again, with the missing term.

        Args:
            model: The MuJoCo model.
            data: The MuJoCo data after a forward pass.
        """
        pairs = self._pairs(data)
        if not pairs:
            return
        contacts, (indices, one, two) = data.contact, np.array(pairs).T
        rows = contacts.efc_address[indices] + 1
        used = (rows > 0) & (contacts.dim[indices] >= 3)
        if not used.any():
            return
        indices, one, two, rows = indices[used], one[used], two[used], rows[used]
        points = contacts.pos[indices]
        between = self.bias(model, data, two, points) - self.bias(model, data, one, points)
        along = np.einsum("ijk,ik->ij", contacts.frame[indices].reshape(-1, 3, 3)[:, 1:], between)
        self.bend(model, data, rows - 1, along)
        mujoco.mj_fwdConstraint(model, data)

    def bend(self, model: Any, data: Any, first: Ints, along: Array) -> None:
        """Adds J̇ q̇ to contacts with friction.

        Args:
            model: The MuJoCo model.
            data: The MuJoCo data after a forward pass.
            first: The first row of each contact.
            along: Along its two tangents, m/s², shape (n, 2).
        """
        step = model.opt.timestep
        # A body moves along a straight line in a step, with its velocity at the end of the step.
        # A part of the term brings its path onto the arc; see docs/physics.md.
        damped = data.efc_KBIP[first + 1, 1:2] * step
        along = along * (1 - 0.5 * damped / (1 + damped))
        aref = data.efc_aref
        aref[first + 1] -= along[:, 0]
        aref[first + 2] -= along[:, 1]

    def bias(self, model: Any, data: Any, bodies: Ints, points: Array) -> Array:
        """J̇ q̇ of points on bodies, m/s², shape (n, 3): what does not depend on q̈."""
        joints = self._joints[bodies]
        spin, arm = data.cvel[bodies, :3], points - data.xanchor[joints]
        inward, squared = np.einsum("ij,ij->i", spin, arm), np.einsum("ij,ij->i", spin, spin)
        found: Array = spin * inward[:, None] - arm * squared[:, None]
        for row in np.flatnonzero(~self._alone[bodies]).tolist():
            mujoco.mj_jacDot(model, data, self._dots, None, points[row], int(bodies[row]))
            found[row] = self._dots @ data.qvel
        return found

    def _pairs(self, data: Any) -> list[tuple[int, int, int]]:
        """Index and bodies of each contact between two trees."""
        if not data.ncon:
            return []
        trees, bodies = self._trees, self._bodies
        return [
            (index, bodies[one], bodies[two])
            for index, (one, two) in enumerate(data.contact.geom.tolist())
            if trees[one] != trees[two] and trees[one] >= 0 and trees[two] >= 0
        ]
