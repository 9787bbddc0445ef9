"""SDF's gearbox joints: two hinges on one reference link with coupled rotations."""

from __future__ import annotations

from dataclasses import replace

from cartwheel.codes.tags import ELEMENT_LEFT_OUT
from cartwheel.description.elements import numbers
from cartwheel.description.elements.xml import Node
from cartwheel.description.model import Joint, Mimic
from cartwheel.description.sdf.context import Context
from cartwheel.description.sdf.frames import WORLD, Frames
from cartwheel.geometry import Quat, rotate


def mesh_gears(
    nodes: list[tuple[Node, str]], joints: list[Joint], ctx: Context, frames: Frames
) -> list[Joint]:
    """The joints with mimics for gearboxes.

    A gearbox constrains theta2 = -ratio theta1, where theta1 rotates the parent and theta2 the
    child relative to the reference body, each about the gearbox's axis. Both are connected to the
    reference body by a hinge, and the second hinge mimics the first. Source: SDF,
    ``<gearbox_ratio>``.

    Args:
        nodes: The gearbox joints, with the names of their frames.
        joints: All other joints in the model.
        ctx: Shared state; receives a warning for each gearbox without effect.
        frames: The model's frames.
    """
    for node, frame in nodes:
        for ignored in ("axis", "axis2", "physics", "pose", "sensor"):
            for part in node.all(ignored):
                part.mark()
        ratio = numbers.within(
            node.number_at("gearbox_ratio", 1.0),
            numbers.MOST_RATIO,
            "gearbox_ratio",
            (node.child("gearbox_ratio") or node).origin,
        )
        reference = node.text_at("gearbox_reference_body").strip()
        ends = []
        for tag in ("parent", "child"):
            written = node.require_child(tag).text.strip()
            link = WORLD if written == WORLD else frames.link_of(written, node.origin)
            ends.append(_hinge(joints, link, reference))
        name = node.attributes.get("name", "")
        if ends[0] is None or ends[1] is None:
            ctx.warn(
                ELEMENT_LEFT_OUT,
                f'the gearbox joint "{name}" has no effect: revolute joints must connect its '
                f'parent and child to the gearbox_reference_body "{reference}"',
                origin=node.origin,
                values={"tag": "joint", "name": name},
            )
            continue
        first, second = ends[0], ends[1]
        if second[0].mimic is not None:
            ctx.warn(
                ELEMENT_LEFT_OUT,
                f'the gearbox joint "{name}" has no effect: joint "{second[0].name}" already '
                "mimics another joint",
                origin=node.origin,
                values={"tag": "joint", "name": name},
            )
            continue
        in_model = frames.pose(frame, node.origin)
        senses = [
            sense * _along(node, tag, joint, frames, in_model.orientation)
            for (joint, sense), tag in ((first, "axis"), (second, "axis2"))
        ]
        multiplier = -ratio * senses[0] * senses[1]
        mimic = Mimic(joint=first[0].name, multiplier=multiplier, mutual=True)
        geared = replace(second[0], mimic=mimic)
        joints = [geared if joint is second[0] else joint for joint in joints]
    return joints


def _hinge(joints: list[Joint], link: str, reference: str) -> tuple[Joint, float] | None:
    """The hinge between a link and the reference, and 1 if it rotates the link, otherwise -1."""
    for joint in joints:
        if joint.type in ("revolute", "continuous"):
            if (joint.parent, joint.child) == (reference, link):
                return joint, 1.0
            if (joint.child, joint.parent) == (reference, link):
                return joint, -1.0
    return None


def _along(node: Node, tag: str, joint: Joint, frames: Frames, orientation: Quat) -> float:
    """The sign of a hinge relative to the gearbox's axis: 1 or -1."""
    stated = node.find(f"{tag}/xyz") or node.find("axis/xyz")
    own = rotate(orientation, stated.vec3() if stated is not None else (0.0, 0.0, 1.0))
    child = frames.pose(joint.child, node.origin)
    axis = rotate((child @ joint.pose).orientation, joint.axis.xyz)
    return -1.0 if sum(a * b for a, b in zip(own, axis, strict=True)) < 0 else 1.0
