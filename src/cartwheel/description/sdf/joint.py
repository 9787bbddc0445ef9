"""SDF's ``<joint>``: types, axes in any frame, limits."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

from cartwheel.codes import robot, tags
from cartwheel.description.elements.xml import Node
from cartwheel.description.model import Axis, Joint, JointType, Sensor
from cartwheel.description.sdf.context import Context, read_pose, reference_of, require_name
from cartwheel.description.sdf.frames import WORLD, Frames
from cartwheel.description.sdf.mimic import read_mimic
from cartwheel.description.sdf.sensors import read_sensor, read_sensors
from cartwheel.description.sdf.zero_axis import accept_zero_axis
from cartwheel.errors import DescriptionError, Diagnostic, Origin, Value
from cartwheel.geometry import Pose, Vec3, quat_conjugate, rotate
from cartwheel.similar_names import meant, suggestion

_TYPES: dict[str, JointType] = {
    "revolute": "revolute",
    "continuous": "continuous",
    "prismatic": "prismatic",
    "fixed": "fixed",
    "ball": "ball",
    "universal": "universal",
    # In practice, two perpendicular axes: a steered wheel, a cardan joint.
    "revolute2": "universal",
    "screw": "screw",
}
GEARBOX = "gearbox"
_UNLIMITED = 1e15
"""SDF's own default limits are ±1e16."""
_WITHOUT_AXIS = ("fixed", "ball")
_ALONG = 0.9
"""Maximum cosine between the two axes of a joint that rotates about both."""


class NoLinkError(DescriptionError):
    """A joint refers to a link that does not exist."""

    code = robot.JOINT_LINK_UNKNOWN


def add_joint(frames: Frames, node: Node, ctx: Context, joints: list[str]) -> str:
    """Adds a joint's frame; returns the frame's name.

    Args:
        frames: Frames of the model or world, complete except for joints.
        node: The ``<joint>``.
        ctx: Shared state of the document.
        joints: The names of all joints: a joint's pose may be relative to another joint.

    Raises:
        NoLinkError: The child link does not exist.
        DescriptionError: The child is the world.
    """
    name = require_name(node)
    pose = node.child("pose")
    frame = name
    if frames.kind_of(name) not in (None, "joint"):
        # Until 1.6, a joint could have the same name as a link, and many files use this.
        frame = joint_frame(name)
        if ctx.version >= (1, 7):
            ctx.warn(
                tags.NAME_TAKEN,
                f'joint "{name}" has the same name as a link or frame',
                origin=node.origin,
                severity="warning",
                values={"name": name},
            )
    child = node.require_child("child").text.strip()
    if child == WORLD and node.attributes.get("type") == "fixed":
        child = node.text_at("parent").strip()
    if child == WORLD:
        raise _world_child(node, name)
    if not frames.has(child) and child not in joints:
        raise NoLinkError(
            f'joint "{name}": child link "{child}" does not exist',
            origin=node.origin,
            hint=suggestion(child, frames.links()),
            values=_unknown_link(name, "child", child, frames),
        )
    frames.add(
        "joint",
        frame,
        read_pose(pose),
        relative_to=reference_of(pose) or child,
        attached_to=child,
        origin=node.origin,
    )
    return frame


def _world_child(node: Node, name: str) -> DescriptionError:
    return node.fail(
        f'joint "{name}": the world cannot be the child',
        "Swap <parent> and <child>.",
        code=robot.JOINT_LINK_UNKNOWN,
        values={"joint": name, "end": "child", "name": WORLD, "meant": ""},
    )


def joint_frame(name: str) -> str:
    """The frame name of a joint that has the same name as a link or frame."""
    return f"__joint__{name}"


def read_joint(node: Node, ctx: Context, frames: Frames, frame: str) -> Joint | None:
    """A joint with its frame in the child link and its axes in the joint frame.

    Args:
        node: The element.
        ctx: Shared state of the document.
        frames: The model's frames, complete.
        frame: Name of the joint's frame.

    Returns:
        None for a gearbox, which couples other joints.
    """
    name = require_name(node)
    written = node.require("type").strip()
    kind = _TYPES.get(written)
    if written == GEARBOX:
        return None
    if kind is None:
        raise node.fail(
            f'joint "{name}" has the unknown type "{written}"',
            suggestion(written, [*_TYPES, GEARBOX]),
            code=robot.JOINT_TYPE_UNKNOWN,
            values={"joint": name, "name": written, "meant": meant(written, [*_TYPES, GEARBOX])},
        )
    parent = _end(node, "parent", name, frames)
    child = _end(node, "child", name, frames)
    if child == WORLD and kind == "fixed":
        parent, child = WORLD, parent  # the constraint is the same in both directions
    if child == WORLD:
        raise _world_child(node, name)
    if parent == child:
        raise node.fail(
            f'joint "{name}" connects link "{child}" to itself',
            code=robot.KINEMATIC_LOOP,
            values={"joint": name},
        )
    in_model = frames.pose(frame, node.origin)
    axis, axis2 = node.child("axis"), node.child("axis2")
    first = Axis()
    if kind not in _WITHOUT_AXIS and axis is None:
        ctx.warn(
            tags.DEFAULT_USED,
            f'joint "{name}" has no <axis>, so the default in SDF, z, is used',
            origin=node.origin,
            values={"joint": name, "missing": "axis"},
        )
    if axis is not None:
        first = _axis(axis, name, ctx, frames, in_model)
        if kind in _WITHOUT_AXIS:
            # Gazebo also ignores it: a ball joint with damping moves freely there.
            first = Axis()
            ctx.warn(
                tags.NOT_SIMULATED,
                f'joint "{name}": the <axis> of a {written} joint has no effect',
                origin=axis.origin,
                values={"joint": name, "tag": "axis"},
            )
    second = None
    if kind == "universal":
        if axis2 is not None:
            second = _axis(axis2, name, ctx, frames, in_model)
        else:  # as in Gazebo's ODE
            along_y = abs(first.xyz[1]) > _ALONG
            second = Axis(xyz=(1.0, 0.0, 0.0) if along_y else (0.0, 1.0, 0.0))
            taken = "x" if along_y else "y"
            ctx.warn(
                tags.DEFAULT_USED,
                f'joint "{name}" has no <axis2>, so {taken} is used',
                origin=node.origin,
                values={"joint": name, "missing": "axis2"},
            )
    mimic = read_mimic(axis, name, kind, ctx) if axis is not None else None
    ode = node.find("physics/ode")
    cfm, erp, feedback, damper = None, None, False, False
    if ode is not None:
        cfm = ode.optional_number_at("limit/cfm")
        erp = ode.optional_number_at("limit/erp")
        feedback = ode.boolean_at("provide_feedback", False)
        older = ode.boolean_at("cfm_damping", False)
        damper = ode.boolean_at("implicit_spring_damper", older)
        suspension = ode.child("suspension") if written == "revolute2" else None
        if suspension is not None:
            suspension.mark()
            if suspension.children:
                ctx.warn(
                    tags.NOT_SIMULATED,
                    f'joint "{name}": <suspension> has no effect because suspensions are rigid '
                    "in Cartwheel",
                    origin=suspension.origin,
                    severity="warning",
                    values={"joint": name, "tag": "suspension"},
                )
    provide = node.find("physics/provide_feedback")
    if provide is not None:
        feedback = provide.boolean()
    return Joint(
        name=name,
        type=kind,
        parent=parent,
        child=child,
        pose=frames.pose(child, node.origin).inverse() @ in_model,
        axis=first,
        axis2=second,
        mimic=mimic,
        thread_pitch=_pitch(node) if kind == "screw" else None,
        stop_cfm=cfm,
        stop_erp=erp,
        provide_feedback=feedback,
        implicit_spring_damper=damper,
        origin=node.origin,
    )


def read_joint_sensors(node: Node, joint: Joint, frames: Frames, ctx: Context) -> list[Sensor]:
    """The sensors of a joint: placed in its frame, attached to its child link."""

    def read(each: Node) -> Sensor:
        stated = each.child("pose")
        relative_to = reference_of(stated)
        own = read_pose(stated)
        if relative_to:
            in_model = frames.placed(own, relative_to, each.origin)
            pose = frames.pose(joint.child, each.origin).inverse() @ in_model
        else:
            pose = joint.pose @ own
        return replace(read_sensor(each, joint.child, pose), joint=joint.name)

    return read_sensors(node.all("sensor"), read, ctx)


def _end(node: Node, tag: str, joint: str, frames: Frames) -> str:
    """The link in a ``<parent>`` or ``<child>``; a frame is resolved to its link."""
    part = node.require_child(tag)
    name = part.text.strip()
    if not name:
        raise part.fail(
            f'joint "{joint}": <{tag}> is empty',
            code=tags.TAG_MISSING,
            values={"joint": joint, "missing": tag},
        )
    if name == WORLD:
        return WORLD
    try:
        return frames.link_of(name, part.origin)
    except DescriptionError as error:
        if frames.has(name):
            raise
        raise NoLinkError(
            f'joint "{joint}": {tag} link "{name}" does not exist',
            origin=part.origin,
            hint=suggestion(name, frames.links()),
            values=_unknown_link(joint, tag, name, frames),
        ) from error


def _unknown_link(joint: str, end: str, name: str, frames: Frames) -> dict[str, Value]:
    return {"joint": joint, "end": end, "name": name, "meant": meant(name, frames.links())}


def _axis(node: Node, joint: str, ctx: Context, frames: Frames, in_model: Pose) -> Axis:
    xyz_node = node.child("xyz")
    xyz: Vec3 = xyz_node.vec3() if xyz_node is not None else (0.0, 0.0, 1.0)
    length = math.sqrt(sum(c * c for c in xyz))
    undirected = False
    if length < 1e-9:
        accept_zero_axis(node, joint, f'joint "{joint}": the axis 0 0 0 has no direction', ctx)
        xyz, length = rotate(quat_conjugate(in_model.orientation), (1.0, 0.0, 0.0)), 1.0
        undirected = True
    xyz = (xyz[0] / length, xyz[1] / length, xyz[2] / length)
    expressed_in = (xyz_node.get("expressed_in") or "").strip() if xyz_node is not None else ""
    in_model_frame = _is_in_model_frame(node, joint, ctx)
    if (in_model_frame or expressed_in) and not undirected:
        frame = frames.pose(expressed_in, node.origin) if expressed_in else Pose()
        xyz = rotate(quat_conjugate(in_model.orientation), rotate(frame.orientation, xyz))
    lower = _limit(node.optional_number_at("limit/lower", infinite=True))
    upper = _limit(node.optional_number_at("limit/upper", infinite=True))
    lower, upper = usable_limits(joint, lower, upper, node.origin, ctx.report)
    return Axis(
        xyz=xyz,
        lower=lower,
        upper=upper,
        effort=_bound(node.optional_number_at("limit/effort", infinite=True)),
        velocity=_bound(node.optional_number_at("limit/velocity", infinite=True)),
        damping=node.number_at("dynamics/damping", 0.0),
        friction=node.number_at("dynamics/friction", 0.0),
        spring_stiffness=node.number_at("dynamics/spring_stiffness", 0.0),
        spring_reference=node.number_at("dynamics/spring_reference", 0.0),
    )


def _is_in_model_frame(axis: Node, joint: str, ctx: Context) -> bool:
    """Whether an axis is in the frame of the model instead of its joint.

    Until 1.4, all axes were. 1.5 and 1.6 have a tag for this, which libsdformat ignores in files
    of later versions.
    """
    tag = "use_parent_model_frame"
    if ctx.version < (1, 7):
        return axis.boolean_at(tag, ctx.version < (1, 5))
    stated = axis.child(tag)
    if stated is not None and stated.text.strip().lower() in ("1", "true"):
        ctx.report(
            tags.TAG_IGNORED.diagnostic(
                f'joint "{joint}": <{tag}> is ignored, because SDF has not had this tag since 1.7',
                origin=stated.origin,
                hint='Use <xyz expressed_in="__model__"> if the axis is in the frame of the model.',
                values={"tag": tag, "parent": axis.tag, "joint": joint},
            )
        )
    return False


_FARTHEST = 1000.0
"""rad or m; limits further from 0, where a joint starts, cannot be meant."""


def _limit(value: float | None) -> float | None:
    return None if value is None or abs(value) >= _UNLIMITED else value


def _bound(value: float | None) -> float | None:
    """Effort and velocity: -1 and infinity mean unlimited."""
    return None if value is None or value < 0 or value >= _UNLIMITED else value


def _pitch(node: Node) -> float:
    """Metres along the axis per turn, positive for a right-handed screw.

    The older ``<thread_pitch>`` is in radians per metre with the opposite sign.
    """
    metres = node.child("screw_thread_pitch")
    old = node.child("thread_pitch")
    if metres is not None:
        return metres.number()
    value = old.number() if old is not None else 1.0
    if value == 0:
        raise node.fail("the thread_pitch of a screw must not be 0")
    return -2 * math.pi / value


def usable_limits(
    joint: str,
    lower: float | None,
    upper: float | None,
    origin: Origin,
    report: Callable[[Diagnostic], None],
) -> tuple[float | None, float | None]:
    """The limits of a joint, rad or m; None for both, with a report, if no position can be between
    them.

    Gazebo's physics engine ignores reversed limits. It would throw a joint that starts far from its
    limits towards them.
    """
    if lower is not None and upper is not None and lower > upper:
        code, why = robot.LIMIT_REVERSED, f"the lower limit {lower:g} is above the upper {upper:g}"
    elif (lower is not None and lower > _FARTHEST) or (upper is not None and upper < -_FARTHEST):
        stated = [f"{each:g}" for each in (lower, upper) if each is not None]
        code = robot.LIMIT_UNREACHABLE
        why = f"it starts at 0, which is far from its limits {' and '.join(stated)}"
    else:
        return lower, upper
    report(
        code.diagnostic(
            f'joint "{joint}": {why}, so the joint is not limited',
            origin=origin,
            values={"joint": joint, "lower": lower, "upper": upper},
        )
    )
    return None, None
