"""A model with values that several rules use."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypeVar

from cartwheel.checks import nodes, plugin_tags
from cartwheel.description.elements.node import Node
from cartwheel.description.model import (
    Collision,
    Element,
    Joint,
    Link,
    Mesh,
    PluginTag,
    RobotDescription,
    Sensor,
    Visual,
)
from cartwheel.description.solids import Floats, Solid, bounds, solid_of
from cartwheel.dialects.tag_roles import wheels
from cartwheel.errors import Origin


@dataclass(frozen=True, kw_only=True, slots=True)
class Drive:
    """A plugin that drives wheels."""

    tag: PluginTag
    left: tuple[str, ...]
    """Joint names."""
    right: tuple[str, ...]
    left_tag: Element | None
    """The tag of the first left joint; None if it contains several joints, or is missing."""

    @property
    def joints(self) -> tuple[str, ...]:
        """Left and right joints."""
        return self.left + self.right


_Value = TypeVar("_Value")
Sides = tuple[tuple[str, ...], tuple[str, ...]]
"""Joints of the left and right wheels."""


class Robot:
    """A model, with cached values that several rules use.

    Args:
        description: The model as read.
        root: The expanded ``<robot>``; None for an SDF model.
        mended: Links whose inertia was replaced.
        cut: Links that lost an unreadable element.
        unseen: Links that lost only visuals.
        displaced: Links whose joint is unreadable, so that their pose is unknown.
    """

    def __init__(
        self,
        description: RobotDescription,
        root: Node | None,
        *,
        mended: Iterable[str] = (),
        cut: Iterable[str] = (),
        unseen: Iterable[str] = (),
        displaced: Iterable[str] = (),
    ) -> None:
        self.description = description
        self.root = root
        self.mended = frozenset(mended)
        self.cut = frozenset(cut)
        self._unseen = frozenset(unseen)
        self.links = {link.name: link for link in description.links}
        self.joints = {joint.name: joint for joint in description.joints}
        self.inbound: dict[str, Joint] = {}
        for joint in description.joints:
            self.inbound.setdefault(joint.child, joint)
        self._displaced = frozenset(displaced)
        self.controlled: tuple[Sides, ...] = ()
        """The wheels of controllers that drive the base."""
        self.steered: tuple[str, ...] = ()
        """Joints that the steering controllers turn."""
        self.idle: frozenset[str] = frozenset()
        """Joints for controllers that nothing commands or holds."""
        self._known: dict[tuple[object, ...], tuple[object, Any]] = {}

    def once(self, kind: str, of: object, compute: Callable[[], _Value]) -> _Value:
        """What `compute` returned for this object the first time, for values of several rules."""
        key = (kind, of if isinstance(of, tuple) else id(of))
        if key not in self._known:
            # With the object, which lives as long as its number stands for it.
            self._known[key] = of, compute()
        known: _Value = self._known[key][1]
        return known

    @cached_property
    def collisions(self) -> dict[str, list[Solid]]:
        """Collision geometry by link."""
        return {link.name: self._solids(link, visual=False) for link in self.description.links}

    @cached_property
    def visuals(self) -> dict[str, list[Solid]]:
        """Visual geometry by link."""
        return {link.name: self._solids(link, visual=True) for link in self.description.links}

    @cached_property
    def in_sdf(self) -> frozenset[str]:
        """Links written in SDF: all links of an SDF model, or those in a <gazebo> element."""
        return frozenset(self.links) - set(map(nodes.name_of, nodes.children(self.root, "link")))

    @cached_property
    def incomplete(self) -> frozenset[str]:
        """Links with a missing mesh, whose remaining geometry is not representative."""
        return self._lacking("visual", "collision")

    @cached_property
    def uncovered(self) -> frozenset[str]:
        """Links with a missing collision mesh, which may touch the ground with it."""
        return self._lacking("collision")

    def _lacking(self, *kinds: str) -> frozenset[str]:
        """Links with a missing mesh in elements of these kinds."""
        found = set(self.cut | self._unseen if "visual" in kinds else self.cut)
        for node in nodes.children(self.root, "link"):
            link = self.links.get(nodes.name_of(node))
            if link is None:
                continue
            written = [
                each
                for kind in kinds
                for part in nodes.children(node, kind)
                for each in nodes.walk(part)
                if each.tag == "mesh"
            ]
            parts: list[Visual | Collision] = [
                *(link.visuals if "visual" in kinds else ()),
                *(link.collisions if "collision" in kinds else ()),
            ]
            if sum(isinstance(part.shape, Mesh) for part in parts) < len(written):
                found.add(link.name)
        return frozenset(found)

    @cached_property
    def placed(self) -> frozenset[str]:
        """Links with a known pose, as the author wrote it."""
        lost, seen = set(self._displaced), set[str]()
        for link in self.links:
            path: dict[str, None] = {}
            each = link
            while each not in lost and each not in seen and each not in path:
                path[each] = None
                if each in self.inbound:
                    each = self.inbound[each].parent
            (lost if each in lost else seen).update(path)
        return frozenset(self.links) - lost

    @property
    def is_placed(self) -> bool:
        """Whether the poses of all links are known."""
        return len(self.placed) == len(self.links)

    def whole(self, link: str, *, looks: bool = True) -> bool:
        """Whether no mesh is missing in a link and the links fixed to it.

        Args:
            link: Name of the link.
            looks: Whether visuals count as well as collisions.
        """
        missing = self.incomplete if looks else self.uncovered
        return missing.isdisjoint(self.rigid_groups[self.rigid_root(link)])

    def solids(self, link: str) -> list[Solid]:
        """Collisions and visuals of a link."""
        return self.collisions.get(link, []) + self.visuals.get(link, [])

    def rigid_root(self, link: str) -> str:
        """The root of the link's rigid group; the link itself if it can move."""
        seen = {link}
        while link in self.inbound and self.inbound[link].type == "fixed":
            parent = self.inbound[link].parent
            if parent in seen or parent not in self.links:
                break
            seen.add(parent)
            link = parent
        return link

    def merged_root(self, link: str) -> str:
        """The link into which Gazebo merges a link of a URDF; the link itself if it remains."""
        seen = {link}
        while link in self.inbound:
            joint = self.inbound[link]
            if joint.type != "fixed" or joint.preserve_fixed or joint.parent not in self.links:
                break
            if joint.parent in seen:
                break
            link = joint.parent
            seen.add(link)
        return link

    def carrying(self, links: Iterable[str]) -> set[str]:
        """Names of the joints between the root link and some links, which are moving joints."""
        found: set[str] = set()
        for link in links:
            joint = self.inbound.get(self.rigid_root(link))
            while joint is not None and joint.name not in found:
                found.add(joint.name)
                joint = self.inbound.get(self.rigid_root(joint.parent))
        return found

    @cached_property
    def rigid_groups(self) -> dict[str, list[str]]:
        """The links of each rigid group, by root link."""
        groups: dict[str, list[str]] = {}
        for link in self.links:
            groups.setdefault(self.rigid_root(link), []).append(link)
        return groups

    def rigid_cloud(self, link: str) -> list[Floats]:
        """Geometry of all links in a rigid group, in the given link's frame."""
        here = self.links[link].pose.inverse()
        return [
            solid.placed(here @ self.links[name].pose)
            for name in self.rigid_groups[self.rigid_root(link)]
            for solid in self.solids(name)
        ]

    @cached_property
    def size(self) -> float:
        """Longest edge of the bounding box of all collisions, or of all visuals if there are none,
        m.
        """
        for kind in (self.collisions, self.visuals):
            found = bounds(
                [
                    solid.placed(self.links[name].pose)
                    for name, solids in kind.items()
                    for solid in solids
                ]
            )
            if found is not None:
                return float((found[1] - found[0]).max())
        return 0.0

    @cached_property
    def drives(self) -> tuple[Drive, ...]:
        """Plugins that drive left and right wheels."""
        found = []
        for tag in self.description.plugins:
            roles = plugin_tags.roles(tag.filename)
            left, right = wheels(roles, "left"), wheels(roles, "right")
            if not left:
                continue
            single = [name for each in left if each.role == "left_wheel" for name in each.tags]
            names = (
                tuple(joint for each in side for joint in each.joints(tag.element))
                for side in (left, right)
            )
            found.append(
                Drive(
                    tag=tag,
                    left=next(names),
                    right=next(names),
                    left_tag=next(filter(None, map(tag.element.find, single)), None),
                )
            )
        return tuple(found)

    @property
    def sides(self) -> tuple[Sides, ...]:
        """Joints of the left and right wheels of each plugin or controller that drives it."""
        return (*((each.left, each.right) for each in self.drives), *self.controlled)

    @cached_property
    def joint_names(self) -> frozenset[str]:
        """Names of all joints, including unreadable ones; scoped names also without their scope."""
        names = {*self.joints, *map(nodes.name_of, nodes.children(self.root, "joint"))}
        return frozenset(names | {name.rpartition("::")[2] for name in names})

    @cached_property
    def driven(self) -> frozenset[str]:
        """Joints that a plugin, a transmission or ros2_control moves."""
        names = {name for drive in self.drives for name in drive.joints}
        for element in self.description.transmissions:
            for joint in element.find_all("joint"):
                names.add((joint.attribute("name") or "").strip())
        for element in self.description.ros2_control:
            for joint in element.find_all("joint"):
                if _is_commanded(joint):
                    names.add((joint.attribute("name") or "").strip())
        return frozenset(names)

    def node_at(self, origin: Origin) -> Node | None:
        """The element with exactly this origin."""
        return self._nodes.get(id(origin))

    @cached_property
    def _nodes(self) -> dict[int, Node]:
        tree = () if self.root is None else nodes.walk(self.root)
        return {id(node.origin): node for node in tree}

    def joint_node(self, name: str) -> Node | None:
        """The joint's element."""
        return next(
            (n for n in nodes.children(self.root, "joint") if nodes.name_of(n) == name), None
        )

    def sensors(self) -> Iterator[tuple[Link, Sensor]]:
        """All sensors, each with its link."""
        for link in self.description.links:
            for sensor in link.sensors:
                yield link, sensor

    def plugins(self) -> Iterator[tuple[PluginTag, Sensor | None]]:
        """Model plugins first, then sensor plugins with their sensors."""
        for tag in self.description.plugins:
            yield tag, None
        for _, sensor in self.sensors():
            for tag in sensor.plugins:
                yield tag, sensor

    def _solids(self, link: Link, *, visual: bool) -> list[Solid]:
        parts = link.visuals if visual else link.collisions
        found = [solid_of(part, link.name) for part in parts]
        return [solid for solid in found if solid is not None and len(solid.vertices)]


def _is_commanded(joint: Element) -> bool:
    """Whether a joint in ros2_control is commanded or mimics another one, not only measured."""
    tags = {each.tag for each in joint.children}
    mimics = (each.attribute("name") == "mimic" for each in joint.find_all("param"))
    return "command_interface" in tags or "state_interface" not in tags or any(mimics)
