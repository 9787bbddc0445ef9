"""Masses and inertias of links, as written and by their geometry."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, cast

import numpy as np

from cartwheel.checks import nodes
from cartwheel.checks.kinematic_tree import ends, inbound_joints, link_names
from cartwheel.checks.robot import Robot
from cartwheel.checks.subject import Subject
from cartwheel.description.elements.node import Node
from cartwheel.description.inertia import impossibility, principal_moments
from cartwheel.description.model import MOMENTS, Box, Collision, Inertial, Link, Visual
from cartwheel.description.sdf.links.inertia import inertial_of
from cartwheel.description.solids import as_collision, bounds
from cartwheel.errors import Origin
from cartwheel.geometry import Pose, Vec3

_PLACE = ("xyz", "rpy")
LIGHT = 0.01
"""Fraction of the robot's mass below which a link's mass hardly matters, and is often arbitrary."""


def moments_of(inertial: Node) -> Vec3 | None:
    """Principal moments of an ``<inertial>``; None if a value is not a number."""
    tensor = nodes.child(inertial, "inertia")
    values = {
        key: nodes.number("0" if tensor is None else tensor.attributes.get(key, "0"))
        for key in MOMENTS
    }
    found = {key: value for key, value in values.items() if value is not None}
    if len(found) < len(MOMENTS):
        return None
    return principal_moments(
        (found["ixx"], found["iyy"], found["izz"]), (found["ixy"], found["ixz"], found["iyz"])
    )


def stated_inertials(subject: Subject) -> Iterator[tuple[str, Inertial]]:
    """The inertias of a URDF as written, by link, without those that are not numbers."""
    for link, inertial in inertials(subject):
        tensor, place = nodes.child(inertial, "inertia"), nodes.child(inertial, "origin")
        mass = nodes.number(nodes.text_of(nodes.child(inertial, "mass"), "value"))
        found = [nodes.number(nodes.text_of(tensor, key) or "0") for key in MOMENTS]
        xyz, rpy = (nodes.numbers(nodes.text_of(place, key) or "0 0 0", 3) for key in _PLACE)
        moments = [value for value in found if value is not None]
        if mass is None or mass <= 0 or len(moments) < len(found) or not (xyz and rpy):
            continue
        values: dict[str, Any] = dict(zip(MOMENTS, moments, strict=True))
        pose = Pose.from_xyz_rpy(cast(Vec3, xyz), cast(Vec3, rpy))
        yield nodes.name_of(link), Inertial(mass=mass, pose=pose, origin=inertial.origin, **values)


def inertials(subject: Subject) -> Iterator[tuple[Node, Node]]:
    """The links of a URDF that have an ``<inertial>``, each with it."""
    if not subject.is_urdf:
        return
    for link in nodes.children(subject.root, "link"):
        inertial = nodes.child(link, "inertial")
        if inertial is not None:
            yield link, inertial


def links_with_mass(subject: Subject) -> Iterator[tuple[Robot, Link, Inertial]]:
    """Movable links with a mass stated by the author."""
    for robot in subject.robots:
        if robot.description.static:
            continue
        for link in robot.description.links:
            inertial = link.inertial
            if inertial is None or link.name in robot.mended:
                continue
            if is_stated(link):
                yield robot, link, inertial


def is_stated(link: Link) -> bool:
    """Whether the author stated the mass; SDF's default of 1 kg and estimates are excluded."""
    return link.inertial is not None and link.inertial.origin is not link.origin


def in_fixed_groups(subject: Subject) -> set[str]:
    """Links connected by fixed joints, which share one combined inertia."""
    joints, names = nodes.children(subject.root, "joint"), link_names(subject)
    holders = inbound_joints(joints, names)
    found = {name for name, joint in holders.items() if nodes.text_of(joint, "type") == "fixed"}
    return found | {ends(holders[name])[0] for name in found}


def shape_inertia(robot: Robot, link: Link) -> Inertial | None:
    """Inertia of a solid with the shape of the link's collisions, or of its visuals."""
    for parts in (link.collisions, link.visuals):
        found = _solid(parts, link.origin)
        if found is not None:
            return found
    box = bounds(robot.rigid_cloud(link.name))
    return None if box is None else _box_inertia(box, link.origin)


def inertia_of_geometry(subject: Subject, link: str) -> Inertial | None:
    """Inertia of a solid with the shape of a link, by the link's name; None without a shape."""
    for robot in subject.robots:
        if link in robot.links:
            return shape_inertia(robot, robot.links[link])
    return None


def _solid(parts: tuple[Collision, ...] | tuple[Visual, ...], origin: Origin) -> Inertial | None:
    try:
        found = inertial_of([as_collision(part) for part in parts], [1.0] * len(parts), origin)
    except Exception:  # noqa: BLE001 - a mesh that cannot be read is another rule's finding
        return None
    if found is None:
        return None
    # The volume of an open surface is arbitrary.
    return None if impossibility(principal_moments(found.diagonal, found.products)) else found


def _box_inertia(box: tuple[np.ndarray, np.ndarray], origin: Origin) -> Inertial | None:
    low, high = box
    size = np.maximum(high - low, 1e-6)
    middle = (low + high) / 2
    part = Collision(
        name="box",
        pose=Pose((float(middle[0]), float(middle[1]), float(middle[2]))),
        shape=Box(size=(float(size[0]), float(size[1]), float(size[2]))),
        origin=origin,
    )
    return inertial_of([part], [1.0], origin)


def ratio_text(value: float) -> str:
    """A number with three digits, without an exponent up to a million times a million."""
    return f"{value:.3g}" if value < 1000 or value > 1e12 else f"{float(f'{value:.3g}'):,.0f}"
