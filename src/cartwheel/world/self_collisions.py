"""Which links of one model collide with each other."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from itertools import combinations
from typing import Any

from cartwheel.description.model import Joint, Link, RobotDescription
from cartwheel.description.self_collision import MOST_LINKS, collides, has_mesh, overlapping
from cartwheel.world.additions import Added
from cartwheel.world.entry import TYRE, ModelEntry, scoped


def exclude_links(
    spec: Any, entry: ModelEntry, description: RobotDescription, *, apart: bool
) -> Iterator[Added]:
    """Links of one model collide only if both enable self-collision, as in Gazebo.

    Links connected by a joint never collide. The engine excludes these pairs itself, except for
    the first joint of a body fixed to the world.

    Args:
        spec: The spec of the world.
        entry: The model.
        description: Its description.
        apart: Whether links with overlapping hulls do not collide either.

    Yields:
        The links with meshes whose convex hulls overlap.
    """
    if description.static:
        return
    inbound: dict[str, Joint] = {}
    for joint in description.joints:
        inbound.setdefault(joint.child, joint)

    def rigid(name: str) -> str:
        """The first link in the group of fixed links that contains this link."""
        joint = inbound.get(name)
        while joint is not None and joint.type == "fixed" and joint.parent != "world":
            name = joint.parent
            joint = inbound.get(name)
        return name

    ends = {(rigid(joint.parent), rigid(joint.child)) for joint in description.joints}
    connected = ends | {(child, parent) for parent, child in ends}

    def body(link: Link) -> str:
        name = scoped(entry.name, link.name)
        return scoped(name, TYRE) if link.name in entry.slips else name

    # A model of 1,000 links has 500,000 pairs.
    solid = [
        (link, body(link), rigid(link.name), collides(description, link))
        for link in description.links
        if link.collisions
    ]
    free: list[tuple[Link, Link]] = []
    bodies = {link.name: name for link, name, _, _ in solid}
    for (link1, name1, group1, free1), (link2, name2, group2, free2) in combinations(solid, 2):
        if not (free1 and free2) or (group1, group2) in connected:
            spec.add_exclude(bodyname1=name1, bodyname2=name2)
        elif group1 != group2 and (has_mesh(link1) or has_mesh(link2)):
            free.append((link1, link2))
    if not apart or sum(each[3] for each in solid) > MOST_LINKS:
        return
    partners: Counter[str] = Counter()
    for first, second in overlapping(free):
        spec.add_exclude(bodyname1=bodies[first.name], bodyname2=bodies[second.name])
        partners.update((first.name, second.name))
    for link, *_ in solid:
        if partners[link.name]:
            yield Added(
                addition="apart-hulls",
                model=entry.name,
                element=link.name,
                value=float(partners[link.name]),
                origin=link.collisions[0].origin,
            )
