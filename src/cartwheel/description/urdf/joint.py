"""URDF's ``<joint>``."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

from cartwheel.codes import robot, tags
from cartwheel.description.elements import numbers
from cartwheel.description.elements.xml import Node
from cartwheel.description.model import WITHOUT_POSITION, Axis, Joint, JointType, Mimic, SoftLimits
from cartwheel.description.sdf.joint import usable_limits
from cartwheel.description.sdf.zero_axis import accept_zero_axis
from cartwheel.description.urdf.context import UrdfContext, read_origin
from cartwheel.errors import Value
from cartwheel.geometry import Pose, Vec3, quat_conjugate, rotate
from cartwheel.similar_names import meant, suggestion

TYPES: dict[str, JointType] = {
    "revolute": "revolute",
    "continuous": "continuous",
    "prismatic": "prismatic",
    "fixed": "fixed",
    "floating": "floating",
    "planar": "planar",
}
_WITHOUT_AXIS = ("fixed", "floating")


def read_joint(node: Node, links: Collection[str], ctx: UrdfContext) -> tuple[Joint, Pose]:
    """A joint, and its frame in its parent link, which is the child's frame at zero.

    Raises:
        DescriptionError: A link does not exist, the axis has length zero in a robot that is not for
            Gazebo Classic, or the type is unknown.
    """
    name = node.require("name").strip()
    written = node.require("type").strip()
    kind = TYPES.get(written)
    if kind is None:
        raise node.fail(
            f'joint "{name}" has the unknown type "{written}"',
            suggestion(written, TYPES),
            code=robot.JOINT_TYPE_UNKNOWN,
            values={"joint": name, "name": written, "meant": meant(written, TYPES)},
        )
    parent, child = _end(node, name, "parent", links), _end(node, name, "child", links)
    if parent == child:
        raise node.fail(
            f'joint "{name}" connects link "{child}" to itself',
            code=robot.KINEMATIC_LOOP,
            values={"joint": name},
        )
    if child == "world":
        raise node.fail(
            f'joint "{name}": the link "world" cannot be a child, since it never moves',
            "Swap <parent> and <child>.",
            code=robot.JOINT_LINK_UNKNOWN,
            values={"joint": name, "name": child},
        )
    safety = node.child("safety_controller")
    mimic = node.child("mimic")
    limits = node.child("limit")
    axis = Axis() if kind in _WITHOUT_AXIS else _axis(node, limits, name, kind, ctx)
    for unused in ("axis", "limit", "dynamics") if kind in _WITHOUT_AXIS else ():
        part = node.child(unused)
        if part is None:
            continue
        part.mark()
        if unused != "axis":  # allowed in URDF
            ctx.warn(
                tags.TAG_IGNORED,
                f'joint "{name}" is {kind}, so its <{unused}> has no effect',
                origin=part.origin,
                severity="info",
                values={"joint": name, "tag": unused},
            )
    joint = Joint(
        name=name,
        type=kind,
        parent=parent,
        child=child,
        axis=axis,
        mimic=_mimic(mimic) if mimic is not None else None,
        soft=_soft(safety) if safety is not None else None,
        origin=node.origin,
    )
    return joint, read_origin(node)


def directed(
    joints: Sequence[Joint], poses: Mapping[str, Pose], undirected: Collection[str]
) -> list[Joint]:
    """Joints in which an axis of length 0 is the x axis of the model; see `accept_zero_axis`.

    Args:
        joints: The joints.
        poses: Poses of the links in the model frame, by name.
        undirected: Names of the joints whose axis has length 0.
    """
    return [
        replace(
            each,
            axis=replace(
                each.axis,
                xyz=rotate(quat_conjugate(poses[each.child].orientation), (1.0, 0.0, 0.0)),
            ),
        )
        if each.name in undirected
        else each
        for each in joints
    ]


def _end(node: Node, joint: str, which: str, links: Collection[str]) -> str:
    end = node.child(which)
    if end is None:
        raise node.fail(
            f'joint "{joint}" has no <{which}>',
            f'Add <{which} link="…"/>.',
            code=tags.TAG_MISSING,
            values={"joint": joint, "missing": which},
        )
    link = end.require("link").strip()
    if link not in links:
        hint = suggestion(link, sorted(links))
        if link == "world":
            hint = 'Add <link name="world"/> to fix the robot to the world.'
        raise end.fail(
            f'joint "{joint}": {which} link "{link}" does not exist',
            hint,
            code=robot.JOINT_LINK_UNKNOWN,
            values={"joint": joint, "name": link, "meant": meant(link, sorted(links))},
        )
    return link


def _axis(node: Node, limits: Node | None, name: str, kind: JointType, ctx: UrdfContext) -> Axis:
    stated = node.child("axis")
    xyz = stated.vec3_of("xyz", (1.0, 0.0, 0.0)) if stated is not None else (1.0, 0.0, 0.0)
    length = math.sqrt(sum(value * value for value in xyz))
    if length < 1e-6:
        assert stated is not None
        said = f'joint "{name}": the axis {stated.attributes.get("xyz")} has length 0'
        accept_zero_axis(stated, name, said, ctx)
        ctx.undirected.add(name)
        xyz, length = (1.0, 0.0, 0.0), 1.0
    unit: Vec3 = (xyz[0] / length, xyz[1] / length, xyz[2] / length)
    lower = upper = effort = velocity = None
    if limits is not None:
        lower = limits.optional_number_of("lower", infinite=True)
        upper = limits.optional_number_of("upper", infinite=True)
        effort = _bound(limits, "effort", name, ctx)
        velocity = _bound(limits, "velocity", name, ctx)
        if kind in ("revolute", "prismatic"):
            lower, upper = lower or 0.0, upper or 0.0
            lower, upper = usable_limits(name, lower, upper, limits.origin, ctx.report)
    elif kind in ("revolute", "prismatic"):
        ctx.warn(
            robot.LIMIT_MISSING,
            f'joint "{name}" of type {kind} has no <limit>; ROS rejects the robot, but '
            "Cartwheel does not limit the joint",
            origin=node.origin,
            severity="warning",
            values={"joint": name},
        )
    if kind not in ("revolute", "prismatic"):
        if lower or upper:
            assert limits is not None
            ctx.warn(
                tags.TAG_IGNORED,
                f'joint "{name}" is {kind}, so its lower and upper limits have no effect',
                origin=limits.origin,
                severity="info",
                values={"joint": name, "tag": "limit"},
            )
        lower = upper = None
    dynamics = node.child("dynamics")
    damping = _not_negative(dynamics, "damping", name, ctx)
    friction = _not_negative(dynamics, "friction", name, ctx)
    return Axis(
        xyz=unit,
        lower=_finite(lower),
        upper=_finite(upper),
        effort=_finite(effort),
        velocity=_finite(velocity),
        damping=damping,
        friction=friction,
    )


def _bound(limits: Node, attribute: str, joint: str, ctx: UrdfContext) -> float | None:
    """The maximum effort or velocity; negative values mean no limit, as in SDF."""
    value = limits.optional_number_of(attribute, infinite=True)
    if value is None or value >= 0:
        return value
    ctx.warn(
        tags.VALUE_IGNORED,
        f'joint "{joint}": the {attribute} limit {value:g} is negative, so there is no limit',
        origin=limits.origin,
        severity="info",
        values={"joint": joint, "attribute": attribute, "stated": value},
    )
    return None


def _finite(value: float | None) -> float | None:
    """A limit; None if it is so large that it has no effect."""
    return value if value is not None and abs(value) < 1e15 else None


def _not_negative(dynamics: Node | None, attribute: str, joint: str, ctx: UrdfContext) -> float:
    if dynamics is None:
        return 0.0
    value = dynamics.number_of(attribute, 0.0)
    if value < 0:
        ctx.warn(
            tags.VALUE_INVALID,
            f'joint "{joint}": the {attribute} {value:g} is negative, which would drive the '
            "joint, so 0 is used",
            origin=dynamics.origin,
            values={"joint": joint, "attribute": attribute, "stated": value},
            mark=attribute,
        )
    return max(0.0, value)


def _mimic(node: Node) -> Mimic:
    def bounded(name: str, default: float, most: float) -> float:
        value = node.number_of(name, default)
        return numbers.within(value, most, f"mimic {name}", node.origin)

    return Mimic(
        # An empty name is that of no joint, so the joint moves independently.
        joint=("" if node.get("joint") == "" else node.require("joint")).strip(),
        multiplier=bounded("multiplier", 1.0, numbers.MOST_RATIO),
        offset=bounded("offset", 0.0, numbers.FARTHEST_JOINT),
    )


def _soft(node: Node) -> SoftLimits:
    return SoftLimits(
        lower=node.number_of("soft_lower_limit", 0.0),
        upper=node.number_of("soft_upper_limit", 0.0),
        k_position=node.number_of("k_position", 0.0),
        k_velocity=node.number_of("k_velocity", 0.0),
    )


def without_invalid_mimics(joints: Sequence[Joint], ctx: UrdfContext) -> list[Joint]:
    """The joints; those that mimic a joint without a position, or each other, move independently
    instead.
    """
    by_name = {joint.name: joint for joint in joints}
    for joint in joints:
        if joint.mimic is None:
            continue
        leader, name = joint.mimic.joint, joint.name
        values: dict[str, Value] = {"joint": name, "name": leader}
        if leader not in by_name:
            others = sorted(set(by_name) - {name})
            message = f'joint "{name}" mimics the joint "{leader}", which does not exist'
            hint = suggestion(leader, others)
            values["meant"] = meant(leader, others)
        elif joint.type == "fixed":
            by_name[name] = replace(joint, mimic=None)  # it does not move in Gazebo either
            continue
        elif joint.type in WITHOUT_POSITION:
            message, hint = f'joint "{name}" is {joint.type}, so it cannot mimic "{leader}"', ""
        elif (kind := by_name[leader].type) in WITHOUT_POSITION:
            message, hint = f'joint "{name}" mimics the joint "{leader}", which is {kind}', ""
        elif _follows_itself(joint, by_name):
            message, hint = f'joint "{name}" mimics itself through "{leader}"', ""
        else:
            continue
        by_name[name] = replace(joint, mimic=None)
        ctx.warn(
            robot.MIMIC_UNKNOWN,
            f"{message}, so it moves independently",
            origin=joint.origin,
            hint=hint,
            values=values,
        )
    return list(by_name.values())


def _follows_itself(joint: Joint, by_name: Mapping[str, Joint]) -> bool:
    seen: set[str] = set()
    leader = joint
    while leader.mimic is not None and leader.mimic.joint in by_name:
        if leader.name in seen:
            return leader is joint
        seen.add(leader.name)
        leader = by_name[leader.mimic.joint]
    return False
