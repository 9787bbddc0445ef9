"""Adds SDF links, joints and frames in a URDF's ``<gazebo>`` to the model."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace

from cartwheel.description.elements.xml import Node
from cartwheel.description.files.packages import Packages
from cartwheel.description.model import Joint, Link, Sensor
from cartwheel.description.sdf.context import Context, Version
from cartwheel.description.sdf.frames import Frames
from cartwheel.description.sdf.gearbox import mesh_gears
from cartwheel.description.sdf.joint import GEARBOX, add_joint, read_joint, read_joint_sensors
from cartwheel.description.sdf.links.link import read_link
from cartwheel.description.sdf.loops import with_roots
from cartwheel.description.sdf.parts import (
    add_frame,
    attach,
    check_mimic,
    frames_of,
    judge,
    left_out,
)
from cartwheel.errors import DescriptionError, Diagnostic, Pickled

INSERTED = ("link", "joint", "frame")
_VERSION: Version = (1, 7)
"""The SDF version to which Gazebo 11 converts a URDF."""


class _RefusedError(Pickled, Exception):
    """An invalid element."""

    def __init__(self, node: Node, error: DescriptionError) -> None:
        super().__init__(error.message)
        self.node = node
        self.error = error


def insert(
    nodes: Sequence[Node],
    links: Sequence[Link],
    joints: Sequence[Joint],
    packages: Packages,
    *,
    name: str,
    canonical_link: str,
    static: bool,
) -> tuple[list[Link], list[Joint], list[Diagnostic]]:
    """Adds parts to a robot; invalid parts are skipped and reported.

    Args:
        nodes: SDF ``<link>``, ``<joint>`` and ``<frame>`` elements, in the robot's frame.
        links: The robot's links, with poses in its frame.
        joints: The robot's joints.
        packages: Resolves file references.
        name: The robot's name.
        canonical_link: The link that the robot's frame is attached to.
        static: Whether the model is static.

    Returns:
        All links, all joints, and the diagnostics.
    """
    if not nodes:
        return list(links), list(joints), []
    kept = list(nodes)
    refused = Context(packages, _VERSION)
    while True:
        frames = frames_of(name, canonical_link, links, joints)
        ctx = Context(packages, _VERSION)
        try:
            found, linked = _build(kept, links, joints, frames, ctx, static=static)
        except _RefusedError as failed:
            # Elements that refer to it must be rejected too, so the rest is read again.
            kept.remove(failed.node)
            left_out(failed.node, failed.error, refused)
            continue
        linked = [*with_roots(found, linked, canonical_link)]
        return found, linked, [*refused.diagnostics, *ctx.diagnostics]


def _build(
    nodes: Sequence[Node],
    links: Sequence[Link],
    joints: Sequence[Joint],
    frames: Frames,
    ctx: Context,
    *,
    static: bool,
) -> tuple[list[Link], list[Joint]]:
    link_nodes, joint_nodes, frame_nodes = (
        [node for node in nodes if node.tag == tag] for tag in INSERTED
    )
    for node in (*link_nodes, *frame_nodes):
        with _blaming(node):
            add_frame(frames, node.tag, node)
    later = [node.attributes.get("name", "") for node in joint_nodes]
    framed: list[tuple[Node, str]] = []
    for node in joint_nodes:
        with _blaming(node):
            framed.append((node, add_joint(frames, node, ctx, later)))
    for node in frame_nodes:
        with _blaming(node):
            frames.pose(node.attributes["name"].strip(), node.origin)
            frames.link_of(node.attributes["name"].strip(), node.origin)
    new_links: list[tuple[Node, Link]] = []
    for node in link_nodes:
        with _blaming(node):
            new_links.append((node, read_link(node, ctx, frames)))
    all_joints = list(joints)
    new_joints: list[tuple[Node, Joint]] = []
    sensors: list[Sensor] = []
    for node, frame in framed:
        with _blaming(node):
            joint = read_joint(node, ctx, frames, frame)
            if joint is not None:
                # Gazebo merges links only over the URDF's own fixed joints.
                joint = replace(joint, preserve_fixed=joint.type == "fixed")
                new_joints.append((node, joint))
                all_joints.append(joint)
                sensors += read_joint_sensors(node, joint, frames, ctx)
    by_name = {joint.name: joint for joint in all_joints}
    for node, joint in new_joints:
        with _blaming(node):
            check_mimic(joint, by_name)
    for node, frame in framed:
        if node.get("type") == GEARBOX:
            with _blaming(node):
                all_joints = mesh_gears([(node, frame)], all_joints, ctx, frames)
    all_links = list(links)
    for node, link in new_links:
        with _blaming(node):
            all_links += judge([link], all_joints, ctx, static=static)
    attach(all_links, sensors)
    return all_links, all_joints


@contextmanager
def _blaming(node: Node) -> Iterator[None]:
    try:
        yield
    except DescriptionError as error:
        raise _RefusedError(node, error) from error
