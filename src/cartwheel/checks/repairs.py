"""Removes or repairs elements that prevent reading a URDF, so that the rest is checked too.

A rule reports each of these faults: like a compiler, the check continues after an error.
"""

from __future__ import annotations

import math

from cartwheel.checks import nodes, spelling
from cartwheel.checks.kinematic_tree import (
    JOINT_TYPES,
    ends,
    inbound_joints,
    main_root,
    mimic_chain,
    rings,
)
from cartwheel.checks.masses import moments_of
from cartwheel.description.elements.node import Node
from cartwheel.description.inertia import impossibility
from cartwheel.description.model import WITHOUT_POSITION

_PLAIN = {"ixx": "1", "ixy": "0", "ixz": "0", "iyy": "1", "iyz": "0", "izz": "1"}
_WEIGHTLESS = 1e-9
"""Mass of a link whose stated mass is not positive, kg, so that sums hardly contain it."""


def mend(root: Node) -> set[str]:
    """Repairs a tree in place; returns the links whose inertia was replaced."""
    _drop_second(root, "link")
    _drop_second(root, "joint")
    links = {nodes.name_of(node) for node in nodes.children(root, "link")}
    _mend_joints(root, links)
    _mend_tree(root, links)
    joints = {nodes.name_of(node): node for node in nodes.children(root, "joint")}
    for name, joint in joints.items():
        mimic = nodes.child(joint, "mimic")
        if mimic is None:
            continue
        leader = nodes.text_of(mimic, "joint")
        if (
            leader not in joints
            or nodes.text_of(joints[leader], "type") in WITHOUT_POSITION
            or nodes.text_of(joint, "type") in WITHOUT_POSITION
            or name in mimic_chain(joints, leader)
        ):
            joint.drop(mimic)
    for node in nodes.children(root, "gazebo"):
        reference = nodes.text_of(node, "reference")
        if reference and reference not in links and reference not in joints:
            root.drop(node)
    return {name for node in nodes.children(root, "link") if (name := _mend_inertia(node))}


def displaced(root: Node, mended: Node) -> set[str]:
    """Links whose joint was changed or lost its origin."""
    kept, written = _places(mended), _places(root)
    moved = {key for key, had in written.items() if kept.get(key) is not had}
    return {key[2] for key in moved | (kept.keys() - written.keys())}


def _places(root: Node) -> dict[tuple[str, str, str], bool]:
    """Whether each joint, by name, parent and child, has an origin."""
    return {
        (nodes.name_of(joint), *ends(joint)): nodes.child(joint, "origin") is not None
        for joint in nodes.children(root, "joint")
    }


def _drop_second(root: Node, tag: str) -> None:
    seen: set[str] = set()
    for node in nodes.children(root, tag):
        name = nodes.name_of(node)
        if name in seen or not name:
            root.drop(node)
        seen.add(name)


def _mend_joints(root: Node, links: set[str]) -> None:
    for index, joint in enumerate(root.children):
        kind = joint.attributes.get("type", "fixed").strip()
        if joint.tag == "joint" and kind not in JOINT_TYPES:
            meant = {"type": spelling.meant(kind, JOINT_TYPES) or "fixed"}
            root.children[index] = Node(
                "joint", {**joint.attributes, **meant}, joint.origin, joint.children, joint.text
            )
    for joint in nodes.children(root, "joint"):
        parent, child = ends(joint)
        if child not in links or child in {parent, "world"}:
            root.drop(joint)
            continue
        if parent not in links:
            if parent != "world":
                root.drop(joint)
                continue
            root.children.insert(0, Node("link", {"name": "world"}, joint.origin))
            links.add("world")
        axis, limit = nodes.child(joint, "axis"), nodes.child(joint, "limit")
        if axis is not None:
            xyz = nodes.numbers(axis.attributes.get("xyz"), 3)
            if xyz is not None and math.hypot(*xyz) < 1e-6:
                joint.drop(axis)
        if limit is not None:
            lower = nodes.number(limit.attributes.get("lower", "0"))
            upper = nodes.number(limit.attributes.get("upper", "0"))
            if lower is not None and upper is not None and lower > upper:
                joint.drop(limit)


def _mend_tree(root: Node, links: set[str]) -> None:
    seen: set[str] = set()
    for joint in nodes.children(root, "joint"):
        _, child = ends(joint)
        if child in seen:
            root.drop(joint)
        seen.add(child)
    holders = inbound_joints(nodes.children(root, "joint"), links)
    for ring in rings(holders):
        root.drop(holders.pop(ring[0]))
    free = [n for n in nodes.children(root, "link") if nodes.name_of(n) not in holders]
    main = main_root(free, nodes.children(root, "joint"))
    for node in free:
        if main is None or node is main:
            continue
        parent, child = nodes.name_of(main), nodes.name_of(node)
        if child == "world":
            parent, child = child, parent
        root.children.append(
            Node(
                "joint",
                {"name": f"{child}__joined", "type": "fixed"},
                node.origin,
                [
                    Node("parent", {"link": parent}, node.origin),
                    Node("child", {"link": child}, node.origin),
                ],
            )
        )


def _mend_inertia(link: Node) -> str:
    """Repairs a link's inertia; returns the link's name if it was changed, otherwise "".

    Rules sum masses, so a positive mass is kept.
    """
    inertial = nodes.child(link, "inertial")
    if inertial is None:
        return ""
    mass = nodes.child(inertial, "mass")
    weight = nodes.number(nodes.text_of(mass, "value"))
    moments = moments_of(inertial)
    wrong = moments is not None and impossibility(moments) is not None
    if mass is None or weight is None or moments is None or (weight > 0 and not wrong):
        return ""
    tensor = nodes.child(inertial, "inertia")
    if tensor is not None:
        inertial.drop(tensor)
    if weight <= 0:
        inertial.drop(mass)
        inertial.children.append(Node("mass", {"value": str(_WEIGHTLESS)}, mass.origin))
    inertial.children.append(Node("inertia", _PLAIN, inertial.origin))
    return nodes.name_of(link)
