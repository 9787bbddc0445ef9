"""Drag for chains of joints, which the integrator would otherwise accelerate.

A step uses the Coriolis forces at its beginning. A body that turns at ω turns by ωh during the
step, and advancing along a tangent increases the length: the energy grows by a factor of (ωh)² per
step. When an undamped arm falls, its energy moves to lighter and lighter links, until the last
links turn so fast that this growth dominates. Therefore each joint in a chain gets a drag that
removes the same energy: ½ h I ω³, with the largest possible inertia I of the carried bodies about
the joint. ``docs/physics.md`` shows how small the drag is at speeds that a step resolves.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

import mujoco
import numpy as np

from cartwheel.geometry import Array, from_wxyz, matrix_from_quat
from cartwheel.world.additions import Added
from cartwheel.world.entry import ModelEntry, scoped

_HINGE, _SLIDE = int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE)
_WEIGHTLESS = 1e-5
"""kg; lighter bodies have no effect."""
_BALANCED = 0.05
"""Fraction of the inertia about the axis below which a rotor counts as balanced."""


def drag(model: mujoco.MjModel, speeds: Mapping[str, float] | None = None) -> dict[int, float]:
    """The drag of each hinge in a chain: the coefficient of ω³, by joint index.

    Args:
        model: The compiled model; its time step is used.
        speeds: Stated maximum velocities by joint name, rad/s.

    Returns:
        N m s³/rad³ for each hinge that moves other joints or is moved by them. Wheels are excluded:
        a balanced body does not change any inertia as it turns. So are hinges whose stated damping
        removes more energy than the integration adds; see `_enough`.
    """
    if not model.njnt:
        return {}
    pivots, carried = _carried(model)
    # A slipping tyre has almost no mass, so it does not make the wheel part of a chain.
    moving = (model.body_dofnum > 0) & (model.body_mass > _WEIGHTLESS)
    found = {}
    for joint in range(model.njnt):
        body = int(model.jnt_bodyid[joint])
        if model.jnt_type[joint] != _HINGE or not moving[body] or model.body_treeid[body] < 0:
            continue
        below = bool(moving[_subtree(model, body)[1:]].any())
        above = bool(model.body_weldid[model.body_parentid[body]]) or model.body_dofnum[body] > 1
        if not (below or above) or (not below and _is_balanced(model, joint, body)):
            continue
        inertia = float(carried[body, 2])
        away = float(np.linalg.norm(model.jnt_pos[joint] - pivots[body]))
        inertia += 2 * away * float(carried[body, 1]) + away**2 * float(carried[body, 0])
        speed = (speeds or {}).get(model.joint(joint).name, math.inf)
        root = int(model.body_rootid[body])
        damping = float(model.dof_damping[model.jnt_dofadr[joint]])
        if damping < _enough(model, inertia, speed, float(carried[root, 1])):
            found[joint] = 0.5 * model.opt.timestep * inertia
    return found


def _enough(model: mujoco.MjModel, inertia: float, speed: float, moment: float) -> float:
    """The damping in N m s/rad that removes more energy than the integration adds to a hinge.

    The damping d removes more energy than the drag ½ h I ω³ if d > ½ h I ω². The hinge turns at no
    more than its maximum velocity, or, if it falls, as fast as the energy of the whole fall can
    turn it. At more than one radian per step, no motion is resolved.

    Args:
        model: The compiled model.
        inertia: The largest inertia about the hinge, kg m².
        speed: Maximum velocity of the hinge, rad/s; infinite if unknown.
        moment: Sum of mass times largest distance from the root of the chain, kg m.
    """
    step, gravity = model.opt.timestep, float(np.linalg.norm(model.opt.gravity))
    energy = max(0.5 * inertia * speed**2, 2 * gravity * moment)
    return float(min(step * energy, 0.5 * inertia / step))


def drag_chains(model: mujoco.MjModel, entries: Iterable[ModelEntry]) -> list[tuple[int, Added]]:
    """Sets the drag of a model's hinges.

    Args:
        model: The compiled model.
        entries: The models in it.

    Returns:
        Joint indices, and what was added; the element is empty for a hinge of no description.
    """
    described = {
        scoped(entry.name, joint.name): (entry, joint)
        for entry in entries
        for joint in entry.description.joints
    }
    speeds = {
        name: joint.axis.velocity
        for name, (_, joint) in described.items()
        if joint.axis.velocity is not None and joint.axis.velocity > 0
    }
    model.dof_dampingpoly[:, 1] = 0.0
    made = []
    for index, coefficient in drag(model, speeds).items():
        model.dof_dampingpoly[model.jnt_dofadr[index], 1] = coefficient
        name = model.joint(index).name
        # The second axis of a universal joint has a name of its own.
        found = described.get(name) or described.get(name.rpartition("::")[0])
        entry, joint = found or (None, None)
        added = Added(
            addition="chain-drag",
            model=entry.name if entry is not None else "",
            element=joint.name if joint is not None else "",
            value=coefficient,
            origin=joint.origin if joint is not None else None,
        )
        made.append((index, added))
    return made


def _carried(model: mujoco.MjModel) -> tuple[Array, Array]:
    """The pivot of each body in its own frame, and the mass carried by it.

    Returns:
        (nbody, 3) in m; and (nbody, 3): Σm, Σmd and Σmd² with the inertia, where d is the maximum
        distance of a mass from the pivot in any joint configuration.
    """
    pivots = np.zeros((model.nbody, 3))
    frames = [matrix_from_quat(from_wxyz(quat)) for quat in model.body_quat]
    travel = np.zeros(model.nbody)
    has_joint = np.zeros(model.nbody, dtype=bool)
    for body in range(1, model.nbody):
        first = int(model.body_jntadr[body])
        if first < 0:
            offset = pivots[model.body_parentid[body]] - model.body_pos[body]
            pivots[body] = frames[body].T @ offset
            continue
        has_joint[body] = True
        pivots[body] = model.jnt_pos[first]
        for joint in range(first, first + int(model.body_jntnum[body])):
            if model.jnt_type[joint] == _SLIDE and model.jnt_limited[joint]:
                travel[body] += float(np.abs(model.jnt_range[joint]).max())
    carried = np.zeros((model.nbody, 3))
    for body in range(model.nbody - 1, 0, -1):
        mass = float(model.body_mass[body])
        away = float(np.linalg.norm(model.body_ipos[body] - pivots[body]))
        own = float(model.body_inertia[body].max())
        carried[body] += (mass, mass * away, mass * away**2 + own)
        parent = int(model.body_parentid[body])
        if not has_joint[body]:
            carried[parent] += carried[body]
            continue
        place = model.body_pos[body] + frames[body] @ pivots[body]
        arm = float(np.linalg.norm(place - pivots[parent])) + float(travel[body])
        m, first_moment, second = carried[body]
        carried[parent] += (m, m * arm + first_moment, m * arm**2 + 2 * arm * first_moment + second)
    return pivots, carried


def _is_balanced(model: mujoco.MjModel, joint: int, body: int) -> bool:
    """Whether a rigid part can turn about its joint without moving any mass."""
    axis = np.asarray(model.jnt_axis[joint])
    anchor = np.asarray(model.jnt_pos[joint])
    mass, moment, tensor = 0.0, np.zeros(3), np.zeros((3, 3))
    places = {body: (np.eye(3), np.zeros(3))}
    for part in _subtree(model, body):
        if part != body:
            R, origin = places[int(model.body_parentid[part])]
            turned = R @ matrix_from_quat(from_wxyz(model.body_quat[part]))
            places[part] = (turned, origin + R @ model.body_pos[part])
        R, origin = places[part]
        own = R @ matrix_from_quat(from_wxyz(model.body_iquat[part]))
        r = origin + R @ model.body_ipos[part] - anchor
        m = float(model.body_mass[part])
        mass += m
        moment += m * r
        tensor += own @ np.diag(model.body_inertia[part]) @ own.T
        tensor += m * (float(r @ r) * np.eye(3) - np.outer(r, r))
    about = float(axis @ tensor @ axis)
    off_axis = moment - float(moment @ axis) * axis
    tilt = tensor @ axis - about * axis
    slack = _BALANCED * about
    return bool(
        float(off_axis @ off_axis) <= slack * mass and math.sqrt(float(tilt @ tilt)) <= slack
    )


def _subtree(model: mujoco.MjModel, body: int) -> list[int]:
    """A body and all its descendants, parents first."""
    found = [body]
    inside = {body}
    # The compiler numbers bodies depth first.
    for other in range(body + 1, model.nbody):
        if int(model.body_parentid[other]) not in inside:
            break
        inside.add(other)
        found.append(other)
    return found
