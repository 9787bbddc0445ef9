"""The links and joints of a URDF as they are written, before they are known to form a tree."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from cartwheel.checks import nodes
from cartwheel.checks.subject import Subject
from cartwheel.description.elements.node import Node

JOINT_TYPES = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar")


def elements_of(subject: Subject, tag: str) -> list[Node]:
    """The direct children of ``<robot>`` with a tag; none in an SDF file."""
    return nodes.children(subject.root, tag) if subject.is_urdf else []


def link_names(subject: Subject) -> set[str]:
    """Names of all links in a URDF."""
    return {nodes.name_of(node) for node in elements_of(subject, "link")}


def ends(joint: Node) -> tuple[str, str]:
    """Parent and child link of a joint."""
    return (
        nodes.text_of(nodes.child(joint, "parent"), "link"),
        nodes.text_of(nodes.child(joint, "child"), "link"),
    )


def rings(holders: Mapping[str, Node]) -> list[list[str]]:
    """Loops of joints, each as a list of links from child to parent.

    Args:
        holders: The parent joint of each link, as returned by `inbound_joints`.
    """
    parents = {link: ends(joint)[0] for link, joint in holders.items()}
    found: list[list[str]] = []
    seen: set[str] = set()
    for start in parents:
        path: dict[str, None] = {}
        link = start
        while link in parents and link not in seen and link not in path:
            path[link] = None
            link = parents[link]
        if link in path:
            ring = list(path)
            found.append(ring[ring.index(link) :])
        seen.update(path)
    return found


def inbound_joints(
    joints: list[Node], links: set[str], *, all_of_them: bool = False
) -> dict[str, Node]:
    """The parent joint of each link; joints to unknown links only with `all_of_them`."""
    found: dict[str, Node] = {}
    for joint in joints:
        parent, child = ends(joint)
        if all_of_them or (parent in links and child in links and parent != child):
            found.setdefault(child, joint)
    return found


def main_root(roots: list[Node], joints: list[Node]) -> Node | None:
    """The root link with the largest subtree; the other roots are disconnected."""
    if not roots:
        return None
    below: dict[str, list[str]] = {}
    for joint in joints:
        parent, child = ends(joint)
        below.setdefault(parent, []).append(child)

    def carried(node: Node) -> int:
        seen = {nodes.name_of(node)}
        stack = list(seen)
        while stack:
            for child in below.get(stack.pop(), ()):
                if child not in seen:
                    seen.add(child)
                    stack.append(child)
        return len(seen)

    return max(roots, key=carried)


def mimic_chain(joints: dict[str, Node], leader: str) -> list[str]:
    """The chain of joints that a mimic joint follows, starting with `leader`."""
    chain: list[str] = []
    while leader in joints and leader not in chain:
        chain.append(leader)
        mimic = nodes.child(joints[leader], "mimic")
        if mimic is None:
            break
        leader = nodes.text_of(mimic, "joint")
    return chain


def joints_with_types(subject: Subject) -> Iterator[tuple[Node, str]]:
    """The joints of a URDF, each with its type."""
    if subject.is_urdf:
        for node in nodes.children(subject.root, "joint"):
            yield node, nodes.text_of(node, "type")
