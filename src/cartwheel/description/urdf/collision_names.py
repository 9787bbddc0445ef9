"""The names of a URDF's collisions in Gazebo.

Gazebo merges links over fixed joints and renames their collisions, in ways that depend on the
version. A contact sensor may use any of these spellings.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

from cartwheel.codes import devices
from cartwheel.description.model import Collision, Link, Sensor
from cartwheel.description.urdf.tree import Tree
from cartwheel.errors import Diagnostic
from cartwheel.similar_names import meant, suggestion

_LUMP = "_fixed_joint_lump__"


def name_collisions(links: Sequence[Link], tree: Tree, preserved: Iterable[str]) -> list[Link]:
    """The links with all spellings of their collisions' names as aliases.

    Args:
        links: All links of the robot.
        tree: Their tree.
        preserved: The fixed joints that Gazebo is configured not to merge.
    """
    kept = frozenset(preserved)
    by_name = {link.name: link for link in links}
    # Gazebo numbers the collisions of all merged links in one sequence. A link's own number is
    # never larger, so it cannot take the name of a later collision.
    counts: dict[str, int] = {}
    named: dict[str, Link] = {}
    taken = {each.name for link in links for each in link.collisions}
    taken.update(alias for link in links for each in link.collisions for alias in each.aliases)
    for name in tree.order:
        link = by_name.get(name)
        if link is None:
            continue
        root = tree.lump_root(name, kept)
        parent = tree.inbound[name].parent if name in tree.inbound else None
        collisions = []
        for index, collision in enumerate(link.collisions):
            count = counts.get(root, 0)
            counts[root] = count + 1
            spellings = []
            if root != name:
                spellings = _lumped(root, parent, name, collision, index=index, count=count)
            new = [each for each in dict.fromkeys(spellings) if each not in taken]
            taken.update(new)
            collisions.append(replace(collision, aliases=(*collision.aliases, *new)))
        named[name] = replace(link, collisions=tuple(collisions))
    return [named.get(link.name, link) for link in links]


def _lumped(
    root: str, parent: str | None, child: str, collision: Collision, *, index: int, count: int
) -> list[str]:
    own = f"_{index}" if index else ""
    of_lump = f"_{count}" if count else ""
    spellings = [
        f"{root}{_LUMP}{child}_collision{own}",
        f"{root}{_LUMP}{child}_collision_collision{own}",
        f"{root}{_LUMP}{collision.name}",
        f"{root}{_LUMP}{child}_collision{of_lump}",
        f"{root}{_LUMP}{child}_collision_collision{of_lump}",
        f"{root}_collision_{child}{own}",
    ]
    if parent is not None and parent != root:
        spellings.append(f"{parent}_collision_{child}{own}")
    return spellings


def check_contact_sensors(links: Sequence[Link]) -> Iterable[Diagnostic]:
    """A warning for each contact sensor that refers to a collision that does not exist."""
    known = {
        name
        for link in links
        for collision in link.collisions
        for name in (collision.name, *collision.aliases)
    }
    for link in links:
        for sensor in link.sensors:
            yield from _unknown_collisions(sensor, link, known)


def _unknown_collisions(sensor: Sensor, link: Link, known: set[str]) -> Iterable[Diagnostic]:
    for asked in sensor.collisions:
        name = asked.rpartition("::")[2]
        if name in known:
            continue
        own = [collision.name for collision in link.collisions]
        near = meant(name, sorted(known))
        yield devices.CONTACT_COLLISION_UNKNOWN.diagnostic(
            f'sensor "{sensor.name}" refers to the collision "{asked}", which does not exist, so '
            "it never reports a contact",
            origin=sensor.origin,
            hint=suggestion(name, sorted(known) if near else own),
            severity="warning",
            values={"sensor": sensor.name, "collision": asked, "meant": near},
        )
