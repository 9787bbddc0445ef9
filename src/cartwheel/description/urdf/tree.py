"""The tree of a URDF's links and joints: checks, poses, rigid parts."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from cartwheel.codes import robot
from cartwheel.description.model import Joint
from cartwheel.errors import DescriptionError, Origin
from cartwheel.geometry import Pose

WORLD = "world"
"""A root link with this name represents the world, as in Gazebo."""


@dataclass(frozen=True, slots=True)
class Tree:
    """The tree of links and joints."""

    root: str
    inbound: dict[str, Joint]
    """Parent joint by child link."""
    children: dict[str, tuple[Joint, ...]]
    """Child joints by parent link, in file order."""
    order: tuple[str, ...]
    """All links, parents before children."""

    def poses(self, frames: dict[str, Pose]) -> dict[str, Pose]:
        """Pose of each link in the root's frame at zero positions.

        Args:
            frames: The joints' frames in their parent links, by name.
        """
        poses = {self.root: Pose()}
        for link in self.order[1:]:
            joint = self.inbound[link]
            poses[link] = poses[joint.parent] @ frames[joint.name]
        return poses

    def rigid_root(self, link: str) -> str:
        """The root of the link's group of fixed joints; the link itself if it can move."""
        while link in self.inbound and self.inbound[link].type == "fixed":
            link = self.inbound[link].parent
        return link

    def lumps(self, preserved: Iterable[str]) -> list[list[str]]:
        """The links that Gazebo merges into each link.

        Args:
            preserved: The fixed joints that Gazebo is configured not to merge.
        """
        kept = frozenset(preserved)
        found: dict[str, list[str]] = {}
        for link in self.order:
            found.setdefault(self.lump_root(link, kept), []).append(link)
        return list(found.values())

    def lump_root(self, link: str, preserved: Iterable[str]) -> str:
        """The link into which Gazebo merges this link, or the link itself.

        Args:
            link: A link.
            preserved: The fixed joints that Gazebo is configured not to merge.
        """
        kept = set(preserved)
        while link in self.inbound:
            joint = self.inbound[link]
            if joint.type != "fixed" or joint.name in kept or joint.parent == WORLD:
                break
            link = joint.parent
        return link


def build_tree(links: Sequence[tuple[str, Origin]], joints: Sequence[Joint]) -> Tree:
    """Checks that the joints connect the links to one tree.

    Raises:
        DescriptionError: A link has two parents, there is a cycle, or more than one root.
    """
    inbound: dict[str, Joint] = {}
    children: dict[str, list[Joint]] = {name: [] for name, _ in links}
    for joint in joints:
        other = inbound.get(joint.child)
        if other is not None:
            raise DescriptionError(
                f'link "{joint.child}" has two parents: joint "{other.name}" connects it to '
                f'"{other.parent}", and joint "{joint.name}" to "{joint.parent}"',
                code=robot.MULTIPLE_PARENTS,
                values={"link": joint.child, "joints": (other.name, joint.name)},
                origin=joint.origin,
                hint=f'Joint "{other.name}" is defined at {other.origin}. In a URDF, each link '
                "has at most one parent.",
            )
        inbound[joint.child] = joint
        children[joint.parent].append(joint)
    roots = [(name, origin) for name, origin in links if name not in inbound]
    if not roots:
        raise _cycle(links[0][0], inbound)
    if len(roots) > 1:
        names = ", ".join(f'"{name}"' for name, _ in roots)
        raise DescriptionError(
            f"the links do not form a single tree: no joint connects {names} to a parent",
            code=robot.MULTIPLE_ROOTS,
            values={"links": tuple(name for name, _ in roots)},
            origin=roots[1][1],
            hint=f'Is a joint with the child link "{roots[1][0]}" missing?',
        )
    order = [roots[0][0]]
    for name in order:
        order.extend(joint.child for joint in children[name])
    if len(order) < len(links):
        reached = set(order)
        raise _cycle(next(name for name, _ in links if name not in reached), inbound)
    return Tree(
        root=roots[0][0],
        inbound=inbound,
        children={name: tuple(each) for name, each in children.items()},
        order=tuple(order),
    )


def _cycle(start: str, inbound: dict[str, Joint]) -> DescriptionError:
    path = [start]
    while inbound[path[-1]].parent not in path:
        path.append(inbound[path[-1]].parent)
    ring = path[path.index(inbound[path[-1]].parent) :]
    ring.append(ring[0])
    joint = inbound[ring[0]]
    return DescriptionError(
        f"the joints form a loop: {' -> '.join(reversed(ring))}",
        code=robot.KINEMATIC_LOOP,
        values={"links": tuple(reversed(ring))},
        origin=joint.origin,
        hint="Reverse or remove one of its joints: a URDF is a tree with one root.",
    )
