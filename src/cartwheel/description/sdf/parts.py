"""Shared by ``<model>`` and SDF in a URDF: combines links, joints, frames and sensors."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

from cartwheel.codes.robot import MIMIC_UNKNOWN
from cartwheel.description.elements.xml import Node
from cartwheel.description.losses import loss
from cartwheel.description.model import WITHOUT_POSITION, Joint, Link, Sensor
from cartwheel.description.sdf.context import Context, read_pose, reference_of, require_name
from cartwheel.description.sdf.frames import Frames
from cartwheel.description.sdf.joint import joint_frame
from cartwheel.description.sdf.links.inertia import judged_inertia
from cartwheel.errors import DescriptionError
from cartwheel.similar_names import meant, suggestion


def frames_of(
    name: str, canonical_link: str, links: Iterable[Link], joints: Iterable[Joint]
) -> Frames:
    """The frames of a URDF, by the names of its links and joints.

    Args:
        name: The robot's name.
        canonical_link: The link that its own frame is attached to.
        links: Links with poses in the robot's frame.
        joints: Joints; a joint may have a link's name.
    """
    frames = Frames("model", name)
    frames.default_link = canonical_link
    for link in links:
        frames.add("link", link.name, link.pose, origin=link.origin)
    for joint in joints:
        taken = frames.kind_of(joint.name) is not None
        frames.add(
            "joint",
            joint_frame(joint.name) if taken else joint.name,
            joint.pose,
            attached_to=joint.child,
            origin=joint.origin,
        )
    return frames


def add_frame(frames: Frames, kind: str, node: Node) -> None:
    """Adds a ``<link>`` or ``<frame>``.

    Raises:
        DescriptionError: The name is missing or in use.
    """
    pose = node.child("pose")
    frames.add(
        kind,
        require_name(node),
        read_pose(pose),
        relative_to=reference_of(pose),
        attached_to=(node.get("attached_to") or "").strip() if kind == "frame" else "",
        origin=node.origin,
    )


def left_out(node: Node, error: DescriptionError, ctx: Context) -> None:
    """Reports an invalid element, which is skipped."""
    node.mark()
    ctx.report(loss(error, f"the {node.tag} is ignored", of=node.tag))


def attach(links: list[Link], sensors: Iterable[Sensor]) -> None:
    """Adds joint sensors to the links that carry them, in place."""
    for sensor in sensors:
        index = next(i for i, link in enumerate(links) if link.name == sensor.link)
        link = links[index]
        links[index] = replace(link, sensors=(*link.sensors, sensor))


def judge(
    links: Sequence[Link], joints: Iterable[Joint], ctx: Context, *, static: bool
) -> list[Link]:
    """The links with physically possible masses and inertias.

    Args:
        links: Links of one model.
        joints: All joints in the model.
        ctx: Receives the diagnostics.
        static: Whether the model is static: its masses are not needed, and many files state wrong
            ones.

    Raises:
        DescriptionError: A movable link has an impossible inertia.
    """
    if static:
        return [
            replace(link, inertial=None) if link.inertial and link.inertial.mass <= 0 else link
            for link in links
        ]
    fixed = {
        end for joint in joints if joint.type == "fixed" for end in (joint.parent, joint.child)
    }
    return [
        replace(link, inertial=judged_inertia(link, rigid=link.name in fixed, ctx=ctx))
        for link in links
    ]


def check_mimic(joint: Joint, joints: Mapping[str, Joint]) -> None:
    """Rejects a joint that mimics a joint that does not exist or does not have one position.

    Raises:
        DescriptionError: It does.
    """
    if joint.mimic is None:
        return
    names = list(joints)
    leader = joints.get(joint.mimic.joint)
    if leader is not None and leader.type in WITHOUT_POSITION:
        raise DescriptionError(
            f'joint "{joint.name}" mimics "{leader.name}", which is a {leader.type} joint',
            code=MIMIC_UNKNOWN,
            values={"joint": joint.name, "name": leader.name},
            origin=joint.origin,
            hint="A joint can only mimic a joint that turns about or slides along an axis.",
        )
    if leader is None:
        raise DescriptionError(
            f'joint "{joint.name}" mimics "{joint.mimic.joint}", which does not exist',
            code=MIMIC_UNKNOWN,
            values={
                "joint": joint.name,
                "name": joint.mimic.joint,
                "meant": meant(joint.mimic.joint, names),
            },
            origin=joint.origin,
            hint=suggestion(joint.mimic.joint, names),
        )
