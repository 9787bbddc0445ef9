"""Adds a description's joints to a MuJoCo spec."""

from __future__ import annotations

import math
from typing import Any

import mujoco
import numpy as np

from cartwheel.description.model import Axis, Joint
from cartwheel.geometry import Array, matrix_from_quat, quat_between, rotate
from cartwheel.world.entry import ModelEntry, scoped

_KIND = mujoco.mjtJoint
_EQUALITY = mujoco.mjtEq
STIFF_REFERENCE = (0.01, 1.0)
"""solref of screws, gears, motors and joint friction: as stiff as the default time step allows."""
STIFF_IMPEDANCE = (0.9999, 0.9999, 0.001, 0.5, 2.0)
"""solimp: a nut under load has no visible slip, and a joint that friction holds does not creep."""
_LOCKED = 1e-6
"""Remaining range of a joint with equal limits on each side, rad or m."""
_LOOP_ARM = 0.1
"""Distance between the two points that a loop-closing hinge holds, m."""


def add_joint(spec: mujoco.MjSpec, entry: ModelEntry, body: Any, joint: Joint) -> None:
    """Adds a joint between a body and its parent; a fixed joint adds nothing.

    A joint with several degrees of freedom becomes several MuJoCo joints: a universal joint has
    ``<name>`` and ``<name>::axis2``; a screw rotates as ``<name>`` and translates as
    ``<name>::travel``.
    """
    name = scoped(entry.name, joint.name)
    axis = rotate(joint.pose.orientation, joint.axis.xyz)
    pos = list(joint.pose.position)
    match joint.type:
        case "revolute" | "continuous" | "prismatic":
            follows = joint.name in entry.mimics
            made = _add_axis(body, name, joint, joint.axis, follows=follows)
            made.frictionloss = friction_of(entry, joint, joint.axis)
            made.type = _KIND.mjJNT_SLIDE if joint.type == "prismatic" else _KIND.mjJNT_HINGE
        case "ball":
            body.add_joint(name=name, type=_KIND.mjJNT_BALL, pos=pos)
        case "universal":
            _add_axis(body, name, joint, joint.axis)
            _add_axis(body, f"{name}::axis2", joint, joint.axis2 or Axis(xyz=(1.0, 0.0, 0.0)))
        case "screw":
            _add_axis(body, name, joint, joint.axis)
            travel = f"{name}::travel"
            body.add_joint(name=travel, type=_KIND.mjJNT_SLIDE, axis=list(axis), pos=pos)
            ratio = (joint.thread_pitch or 0.0) / (2 * math.pi)
            couple(spec, f"{name}::thread", travel, name, ratio=ratio)
        case "planar":
            across = matrix_from_quat(quat_between((0.0, 0.0, 1.0), axis))
            for index in range(2):
                _slide(body, f"{name}::{'xy'[index]}", across[:, index])
            body.add_joint(name=name, type=_KIND.mjJNT_HINGE, axis=list(axis), pos=pos)
        case "floating":
            for index in range(3):
                _slide(body, f"{name}::{'xyz'[index]}", np.eye(3)[index])
            body.add_joint(name=name, type=_KIND.mjJNT_BALL)


def axes_of(joint: Joint) -> tuple[tuple[str, Axis], ...]:
    """The axes with properties of their own, with the suffixes of their joints' names."""
    match joint.type:
        case "revolute" | "continuous" | "prismatic" | "screw":
            return (("", joint.axis),)
        case "universal":
            return ("", joint.axis), ("::axis2", joint.axis2 or Axis(xyz=(1.0, 0.0, 0.0)))
    return ()


def limits_of(joint: Joint, axis: Axis, *, follows: bool) -> tuple[float, float] | None:
    """The range of an axis, rad or m; None is unlimited.

    Args:
        joint: The joint.
        axis: One of its axes.
        follows: Whether it follows another joint, besides a mimic in its description.
    """
    if joint.type == "continuous" or (axis.lower is None and axis.upper is None):
        return None
    if axis.locks and joint.type in ("revolute", "prismatic") and (follows or joint.mimic):
        # A following joint is limited by its leader.
        return None
    lower = -1e10 if axis.lower is None else axis.lower
    upper = 1e10 if axis.upper is None else axis.upper
    # The engine requires a range; equal limits lock a joint, as in ODE.
    slack = _LOCKED if axis.locks else 0.0
    return lower - slack, upper + slack


def friction_of(entry: ModelEntry, joint: Joint, axis: Axis) -> float:
    """The dry friction of an axis, N m or N; 0 if a motor of the model replaces it."""
    motor = entry.motors.get(joint.name)
    return 0.0 if motor is not None and motor.replaces_friction else axis.friction


def couple(
    spec: mujoco.MjSpec,
    name: str,
    follower: str,
    leader: str,
    *,
    ratio: float,
    offset: float = 0.0,
    clamped: bool = False,
) -> None:
    """Constrains follower = ratio * leader + offset, both with one degree of freedom.

    The engine uses the sum of both inverse inertias for the constraint, which determines its
    softness. Written for the joint that moves more, the constraint is never softer than intended.
    A `clamped` follower comes first, and the ratio and offset are stored a second time, until
    `Followers` writes the constraint for the positions of the joints.
    """
    stored = (1.0, offset, ratio) if clamped else ()
    if reverses(ratio) and not clamped:
        follower, leader = leader, follower
        ratio, offset = reversed_coupling(ratio, offset)
    spec.add_equality(
        name=name,
        type=_EQUALITY.mjEQ_JOINT,
        objtype=mujoco.mjtObj.mjOBJ_JOINT,
        name1=follower,
        name2=leader,
        data=equality_data(offset, ratio, *([0.0] * 3 if stored else ()), *stored),
        solref=list(STIFF_REFERENCE),
        solimp=list(STIFF_IMPEDANCE),
    )


def reverses(ratio: float) -> bool:
    """Whether a coupling is written for its leader, because the leader moves more."""
    return 0 < abs(ratio) < 1


def reversed_coupling(ratio: float, offset: float) -> tuple[float, float]:
    """The ratio and the offset of a coupling that is written for its leader."""
    return 1 / ratio, -offset / ratio


def close_loop(spec: mujoco.MjSpec, entry: ModelEntry, joint: Joint) -> None:
    """Adds a constraint for a link that already has a parent joint.

    A fixed joint constrains the whole pose, a revolute joint two points on its axis, and any other
    joint one point.
    """
    parent = "world" if joint.parent == "world" else scoped(entry.name, joint.parent)
    _hold(spec, scoped(entry.name, joint.name), scoped(entry.name, joint.child), parent, joint)


def join_models(spec: mujoco.MjSpec, joint: Joint) -> bool:
    """Connects links of two models as `close_loop` does; the links do not collide.

    Returns:
        False if a link does not exist, for example because its model was deleted.
    """
    if any(spec.body(name) is None for name in (joint.parent, joint.child)):
        return False
    made = _hold(spec, scoped("world", joint.name), joint.child, joint.parent, joint)
    for each in made:
        each.solref, each.solimp = list(STIFF_REFERENCE), list(STIFF_IMPEDANCE)
    spec.add_exclude(bodyname1=joint.parent, bodyname2=joint.child)
    return True


def _hold(spec: mujoco.MjSpec, name: str, child: str, parent: str, joint: Joint) -> list[Any]:
    points = [joint.pose.position]
    if joint.type in ("revolute", "continuous"):
        axis = rotate(joint.pose.orientation, joint.axis.xyz)
        x, y, z = joint.pose.position
        arm = [_LOOP_ARM * c for c in axis]
        points.append((x + arm[0], y + arm[1], z + arm[2]))
    return [
        spec.add_equality(
            name=f"{name}::{number}" if number else name,
            type=_EQUALITY.mjEQ_WELD if joint.type == "fixed" else _EQUALITY.mjEQ_CONNECT,
            objtype=mujoco.mjtObj.mjOBJ_BODY,
            name1=child,
            name2=parent,
            # A weld's relative pose is that of the model as built; the last number weights the
            # orientation.
            data=equality_data(*point, *([0.0] * 7), 1.0),
        )
        for number, point in enumerate(points)
    ]


def add_attachment(spec: mujoco.MjSpec, name: str) -> None:
    """Adds an inactive weld; see `AttachmentHandle`.

    A weld requires two bodies; any will do. A world without two bodies needs no welds.
    """
    if not spec.worldbody.bodies:
        return
    spec.add_equality(
        name=name,
        type=_EQUALITY.mjEQ_WELD,
        objtype=mujoco.mjtObj.mjOBJ_BODY,
        name1="world",
        name2=spec.worldbody.bodies[0].name,
        active=False,
        solref=list(STIFF_REFERENCE),
        solimp=list(STIFF_IMPEDANCE),
        data=equality_data(*([0.0] * 10), 1.0),
    )


def equality_data(*values: float) -> list[float]:
    """Data of an equality constraint, padded to the length that the engine requires."""
    return [*values, *([0.0] * (mujoco.mjNEQDATA - len(values)))]


def _add_axis(body: Any, name: str, joint: Joint, axis: Axis, *, follows: bool = False) -> Any:
    made = body.add_joint(
        name=name,
        type=_KIND.mjJNT_HINGE,
        axis=list(rotate(joint.pose.orientation, axis.xyz)),
        pos=list(joint.pose.position),
    )
    made.damping = [axis.damping, 0, 0]
    made.frictionloss = axis.friction
    made.solref_friction = list(STIFF_REFERENCE)
    made.solimp_friction = list(STIFF_IMPEDANCE)
    if axis.spring_stiffness:
        made.stiffness = [axis.spring_stiffness, 0, 0]
        made.springref = axis.spring_reference
    bounds = limits_of(joint, axis, follows=follows)
    if bounds is not None:
        made.limited = mujoco.mjtLimited.mjLIMITED_TRUE
        made.range = list(bounds)
        made.solimp_limit = list(STIFF_IMPEDANCE)
    if axis.effort is not None and axis.effort > 0:
        made.actfrclimited = mujoco.mjtLimited.mjLIMITED_TRUE
        made.actfrcrange = [-axis.effort, axis.effort]
    return made


def _slide(body: Any, name: str, axis: Array) -> None:
    body.add_joint(name=name, type=_KIND.mjJNT_SLIDE, axis=axis.tolist())
