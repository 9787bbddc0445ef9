"""What the rules look at: a description as its author wrote it, and what was read of it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from cartwheel.codes.files import FILE_MISSING, FILE_ON_NETWORK
from cartwheel.description import xml
from cartwheel.description.check import nodes
from cartwheel.description.check.control_files import ControlFile
from cartwheel.description.check.solids import Floats, Solid, bounds, solid_of
from cartwheel.description.model import (
    Collision,
    Joint,
    Link,
    Mesh,
    PluginTag,
    RobotDescription,
    Sensor,
    Visual,
    WorldDescription,
)
from cartwheel.description.node import Node
from cartwheel.description.packages import Packages
from cartwheel.errors import Diagnostic, Origin


@dataclass(frozen=True, kw_only=True, slots=True)
class PluginKnowledge:
    """What the rooms above know of plugins, passed down by who calls."""

    filenames: tuple[str, ...]
    """Such as ``libgazebo_ros_camera.so``."""
    judge: Callable[[PluginTag, Sensor | None], Iterable[Diagnostic] | None]
    """What is wrong with a plugin's parameters; None for a plugin that is not known."""
    default_joints: Callable[[PluginTag], Iterable[tuple[tuple[str, ...], str]]] | None = None
    """Joints that a plugin uses because no tag names one: the tag's spellings, and the joint."""
    controller_types: tuple[str, ...] = ()
    """Such as ``effort_controllers/JointPositionController``; empty where none is known."""
    controller_files: Callable[[Path, Sequence[str]], Sequence[Path]] | None = None
    """From a robot's file and its joints to files that a launch file could start."""


ABSENT = frozenset({FILE_MISSING, FILE_ON_NETWORK})
"""Codes of files, models and packages that do not exist here."""
GAZEBO_STEP = 0.001
"""s, where a world states none."""
DRIVES = ("diff_drive", "diffdrive", "diff-drive")
SKIDS = ("skid_steer", "skid-steer")
MULTI_WHEEL = "diffdrive_plugin_multi_wheel"
KOBUKI = "gazebo_ros_kobuki"
DRIVE_JOINT_TAGS = (
    "leftJoint", "left_joint", "rightJoint", "right_joint", "leftFrontJoint", "leftRearJoint",
    "rightFrontJoint", "rightRearJoint",
)  # fmt: skip


@dataclass(frozen=True, kw_only=True, slots=True)
class Drive:
    """A plugin that drives wheels."""

    tag: PluginTag
    left: tuple[str, ...]
    """Joints."""
    right: tuple[str, ...]

    @property
    def joints(self) -> tuple[str, ...]:
        """All of them."""
        return self.left + self.right


class Robot:
    """One model, with what the rules ask of it again and again.

    Args:
        description: As it was read.
        root: The expanded ``<robot>``; None for a model of SDF.
        mended: Links whose inertia is not the author's any more.
        cut: Links of which something could not be read.
        displaced: Links whose joint was: nobody knows where they are.
    """

    def __init__(
        self,
        description: RobotDescription,
        root: Node | None,
        *,
        mended: Iterable[str] = (),
        cut: Iterable[str] = (),
        displaced: Iterable[str] = (),
    ) -> None:
        self.description = description
        self.root = root
        self.mended = frozenset(mended)
        self.cut = frozenset(cut)
        self.links = {link.name: link for link in description.links}
        self.joints = {joint.name: joint for joint in description.joints}
        self.inbound: dict[str, Joint] = {}
        for joint in description.joints:
            self.inbound.setdefault(joint.child, joint)
        self._displaced = frozenset(displaced)

    @cached_property
    def collisions(self) -> dict[str, list[Solid]]:
        """By link."""
        return {link.name: self._solids(link, visual=False) for link in self.description.links}

    @cached_property
    def visuals(self) -> dict[str, list[Solid]]:
        """By link."""
        return {link.name: self._solids(link, visual=True) for link in self.description.links}

    @cached_property
    def in_sdf(self) -> frozenset[str]:
        """The links that are written in SDF's words: all of a model, or those in a <gazebo>."""
        return frozenset(self.links) - set(map(nodes.name_of, nodes.children(self.root, "link")))

    @cached_property
    def incomplete(self) -> frozenset[str]:
        """Links of which a mesh is missing: what is measured on the rest says little."""
        found = set(self.cut)
        for node in nodes.children(self.root, "link"):
            link = self.links.get(nodes.name_of(node))
            if link is not None:
                written = sum(each.tag == "mesh" for each in nodes.walk(node))
                parts: tuple[Visual | Collision, ...] = (*link.visuals, *link.collisions)
                read = sum(isinstance(part.shape, Mesh) for part in parts)
                if read < written:
                    found.add(link.name)
        return frozenset(found)

    @cached_property
    def placed(self) -> frozenset[str]:
        """Links whose place is the author's."""
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
        """Whether all of its links are where the author has them."""
        return len(self.placed) == len(self.links)

    def whole(self, link: str) -> bool:
        """Whether all meshes of a link, and of what is fixed to it, are there."""
        return self.incomplete.isdisjoint(self.rigid_groups[self.rigid_root(link)])

    def solids(self, link: str) -> list[Solid]:
        """Collisions and visuals."""
        return self.collisions.get(link, []) + self.visuals.get(link, [])

    def rigid_root(self, link: str) -> str:
        """The link that this one is fixed to, itself where it moves."""
        seen = {link}
        while link in self.inbound and self.inbound[link].type == "fixed":
            parent = self.inbound[link].parent
            if parent in seen or parent not in self.links:
                break
            seen.add(parent)
            link = parent
        return link

    @cached_property
    def rigid_groups(self) -> dict[str, list[str]]:
        """The links of each rigid part, by the link that the others are fixed to."""
        groups: dict[str, list[str]] = {}
        for link in self.links:
            groups.setdefault(self.rigid_root(link), []).append(link)
        return groups

    def rigid_cloud(self, link: str) -> list[Floats]:
        """The geometry of all that is fixed to a link, in that link's frame."""
        here = self.links[link].pose.inverse()
        return [
            solid.placed(here @ self.links[name].pose)
            for name in self.rigid_groups[self.rigid_root(link)]
            for solid in self.solids(name)
        ]

    @cached_property
    def size(self) -> float:
        """The longest edge of the box around its collisions, or where it has none its visuals."""
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
        """Plugins that drive wheels, by the tags of both generations of Gazebo."""
        found = []
        for tag in self.description.plugins:
            if MULTI_WHEEL in tag.filename:
                both = [
                    " ".join(_texts(tag, f"{side}Joints")).split() for side in ("left", "right")
                ]
                found.append(Drive(tag=tag, left=tuple(both[0]), right=tuple(both[1])))
            elif KOBUKI in tag.filename:
                found.append(
                    Drive(
                        tag=tag,
                        left=_texts(tag, "left_wheel_joint_name"),
                        right=_texts(tag, "right_wheel_joint_name"),
                    )
                )
            elif any(name in tag.filename for name in DRIVES):
                found.append(
                    Drive(
                        tag=tag,
                        left=_texts(tag, "leftJoint", "left_joint") or ("left_joint",),
                        right=_texts(tag, "rightJoint", "right_joint") or ("right_joint",),
                    )
                )
            elif any(name in tag.filename for name in SKIDS):
                sides = [
                    tuple(
                        text
                        for end in ("Front", "Rear")
                        for text in _texts(tag, f"{side}{end}Joint")
                    )
                    for side in ("left", "right")
                ]
                found.append(Drive(tag=tag, left=sides[0], right=sides[1]))
        return tuple(found)

    @cached_property
    def joint_names(self) -> frozenset[str]:
        """Of all joints, those that could not be read as well; scoped ones without scope too."""
        names = {*self.joints, *map(nodes.name_of, nodes.children(self.root, "joint"))}
        return frozenset(names | {name.rpartition("::")[2] for name in names})

    @cached_property
    def driven(self) -> frozenset[str]:
        """Joints that a plugin, a transmission or ros2_control moves."""
        names = {name for drive in self.drives for name in drive.joints}
        for element in (*self.description.transmissions, *self.description.ros2_control):
            for joint in element.find_all("joint"):
                names.add((joint.attribute("name") or "").strip())
        return frozenset(names)

    def node_at(self, origin: Origin) -> Node | None:
        """The element of that very place."""
        return self._nodes.get(id(origin))

    @cached_property
    def _nodes(self) -> dict[int, Node]:
        tree = () if self.root is None else nodes.walk(self.root)
        return {id(node.origin): node for node in tree}

    def joint_node(self, name: str) -> Node | None:
        """The joint as written."""
        return next(
            (n for n in nodes.children(self.root, "joint") if nodes.name_of(n) == name), None
        )

    def sensors(self) -> Iterator[tuple[Link, Sensor]]:
        """All of them with their links."""
        for link in self.description.links:
            for sensor in link.sensors:
                yield link, sensor

    def plugins(self) -> Iterator[tuple[PluginTag, Sensor | None]]:
        """Those of the robot, then those in its sensors."""
        for tag in self.description.plugins:
            yield tag, None
        for _, sensor in self.sensors():
            for tag in sensor.plugins:
                yield tag, sensor

    def _solids(self, link: Link, *, visual: bool) -> list[Solid]:
        parts = link.visuals if visual else link.collisions
        found = [solid_of(part, link.name) for part in parts]
        return [solid for solid in found if solid is not None and len(solid.vertices)]


@dataclass(kw_only=True)
class Subject:
    """A description under check."""

    root: Node
    """Expanded, as written; nothing in it is counted as read."""
    files: Sequence[str]
    """All that xacro read, the one that was named first."""
    packages: Packages
    read: RobotDescription | WorldDescription | None = None
    """None where it could not be read."""
    robots: tuple[Robot, ...] = ()
    failures: tuple[Diagnostic, ...] = ()
    """What ended its reading, apart from what has a rule of its own."""
    gaps: Sequence[Origin] = ()
    """The places of elements that lack a part that could not be read, and of their holders."""
    plugins: PluginKnowledge | None = None
    control: Sequence[tuple[Robot, ControlFile]] = ()
    """The files of each robot's controllers."""

    @property
    def is_urdf(self) -> bool:
        """Whether it is a URDF, or a xacro of one."""
        return self.root.tag == "robot"

    def in_sdf(self, origin: Origin | None) -> bool:
        """Whether an element of that very place is written in SDF's words."""
        return not self.is_urdf or id(origin) in self._inserted

    @cached_property
    def _inserted(self) -> frozenset[int]:
        """Of the places in a ``<gazebo>`` that refers to nothing."""
        tags = nodes.children(self.root, "gazebo")
        whole = [tag for tag in tags if not nodes.text_of(tag, "reference")]
        return frozenset(id(node.origin) for tag in whole for node in nodes.walk(tag))

    @cached_property
    def written(self) -> tuple[Node, ...]:
        """Each file that xacro read, before its expansion; without those that cannot be read."""
        trees = (xml.readable_file(Path(file)) for file in self.files)
        return tuple(tree for tree in trees if tree is not None)

    @cached_property
    def macros(self) -> frozenset[str]:
        """The names of the macros that its files define."""
        return frozenset(
            nodes.name_of(node).removeprefix("xacro:")
            for tree in self.written
            for node in nodes.walk(tree)
            if node.tag == "xacro:macro"
        )

    def node_at(self, origin: Origin | None) -> Node | None:
        """The element of that very place."""
        return None if origin is None else self._at.get(id(origin))

    def holder_of(self, node: Node) -> Node | None:
        """The element that holds another."""
        return self._holders.get(id(node))

    @cached_property
    def _at(self) -> dict[int, Node]:
        found: dict[int, Node] = {}
        for node in nodes.walk(self.root):
            found.setdefault(id(node.origin), node)
        return found

    @cached_property
    def _holders(self) -> dict[int, Node]:
        return {id(child): node for node in nodes.walk(self.root) for child in node.children}

    @cached_property
    def joints_written(self) -> frozenset[str]:
        """The names of all joints in the file, of those that could not be read as well."""
        return frozenset(nodes.name_of(n) for n in nodes.walk(self.root) if n.tag == "joint")

    @cached_property
    def lacks_models(self) -> bool:
        """Whether a model that it includes does not exist here, so that its content is unknown."""
        diagnostics = () if self.read is None else self.read.diagnostics
        return any(
            each.code in ABSENT and each.values.get("kind") == "model" for each in diagnostics
        )

    @property
    def step(self) -> float:
        """s of the physics, as Gazebo would take it."""
        if isinstance(self.read, WorldDescription) and self.read.physics.max_step_size:
            return self.read.physics.max_step_size
        return GAZEBO_STEP


def _texts(tag: PluginTag, *names: str) -> tuple[str, ...]:
    """The words of the first of these tags that is written; several where it is repeated."""
    for name in names:
        found = [text for child in tag.element.find_all(name) if (text := child.text.strip())]
        if found:
            return tuple(found)
    return ()
