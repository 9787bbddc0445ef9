"""Loops of joints through the root of a model, which Gazebo Classic's engine allows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from cartwheel.description.model import Axis, Joint, Link


def with_roots(
    links: Sequence[Link], joints: Sequence[Joint], canonical_link: str
) -> tuple[Joint, ...]:
    """The joints, so that first parents connect each link to a root, or to the world.

    In a linkage that ends at the body, each link is the child of a joint. Then the canonical link,
    or else the first link in the loop, becomes the root: the joints above it are reversed and moved
    to the end, where they close the loop. A link that a joint connects to the world is preferred.
    """
    roots = _new_roots(links, joints, canonical_link)
    if not roots:
        return tuple(joints)
    placed = {link.name: link for link in links}
    above = [joint for joint in joints if joint.child in roots]
    return (
        *(joint for joint in above if joint.parent == "world"),
        *(joint for joint in joints if joint.child not in roots),
        *(_reversed(joint, placed) for joint in above if joint.parent != "world"),
    )


def _new_roots(links: Sequence[Link], joints: Sequence[Joint], canonical_link: str) -> set[str]:
    """One link in each loop that no chain of first parents connects to a root."""
    parents: dict[str, str] = {}
    for joint in joints:
        parents.setdefault(joint.child, joint.parent)
    grounded = {joint.child for joint in joints if joint.parent == "world"}
    order = {link.name: number for number, link in enumerate(links)}
    order[canonical_link] = -1
    found: set[str] = set()
    rooted: set[str] = set()
    for start in order:
        name, chain = start, dict[str, None]()
        while name in parents and name not in rooted and name not in chain:
            chain[name] = None
            name = parents[name]
        if name in chain:
            path = list(chain)
            ring = path[path.index(name) :]
            found.add(min(ring, key=lambda each: (each not in grounded, order[each])))
        rooted.update(chain)
    return found


def _reversed(joint: Joint, links: dict[str, Link]) -> Joint:
    """The same joint with its links swapped; its positions have the same sign."""
    between = links[joint.parent].pose.inverse() @ links[joint.child].pose
    return replace(
        joint,
        parent=joint.child,
        child=joint.parent,
        pose=between @ joint.pose,
        axis=_opposite(joint.axis),
        axis2=None if joint.axis2 is None else _opposite(joint.axis2),
    )


def _opposite(axis: Axis) -> Axis:
    x, y, z = axis.xyz
    return replace(axis, xyz=(-x, -y, -z))
