"""Joints that mimic others, since SDF 1.11."""

from __future__ import annotations

from cartwheel.codes import robot
from cartwheel.description.elements import numbers
from cartwheel.description.elements.xml import Node
from cartwheel.description.model import WITHOUT_POSITION, JointType, Mimic
from cartwheel.description.sdf.context import Context


def read_mimic(axis: Node, joint: str, kind: JointType, ctx: Context) -> Mimic | None:
    """The ``<mimic>`` of an axis: q = multiplier (leader - reference) + offset.

    Gazebo does not read the axes of ball and fixed joints, so theirs is left out.

    Args:
        axis: The ``<axis>``.
        joint: The name of the joint.
        kind: Its type.
        ctx: Receives the warning that a joint cannot mimic another one.

    Raises:
        DescriptionError: A number is invalid or too large.
    """
    node = axis.child("mimic")
    if node is None:
        return None

    def bounded(path: str, default: float, most: float) -> float:
        origin = (node.child(path) or node).origin
        return numbers.within(node.number_at(path, default), most, f"<{path}>", origin)

    farthest = numbers.FARTHEST_JOINT
    multiplier = bounded("multiplier", 1.0, numbers.MOST_RATIO)
    offset = bounded("offset", 0.0, farthest) - multiplier * bounded("reference", 0.0, farthest)
    numbers.within(offset, farthest, "offset - multiplier x reference of <mimic>", node.origin)
    leader = node.require("joint").strip()
    if kind in WITHOUT_POSITION:
        ctx.warn(
            robot.MIMIC_UNKNOWN,
            f'joint "{joint}" is a {kind} joint, so it cannot mimic "{leader}"',
            origin=node.origin,
            severity="warning",
            values={"joint": joint, "name": leader},
        )
        return None
    return Mimic(joint=leader, multiplier=multiplier, offset=offset)
