"""The input of the rules: a description as written, and the models read from it."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

from cartwheel.checks import nodes
from cartwheel.checks.controller_files import ControlFile
from cartwheel.checks.robot import Robot
from cartwheel.codes.files import FILE_MISSING, FILE_ON_NETWORK
from cartwheel.description.elements import xml
from cartwheel.description.elements.node import Node
from cartwheel.description.elements.simulator import simulator_of
from cartwheel.description.files.packages import Packages
from cartwheel.description.files.source_folders import source_folders
from cartwheel.description.launches import LaunchUse, OwnLaunches, chosen
from cartwheel.description.model import RobotDescription, Simulator, WorldDescription
from cartwheel.dialects.ros_control.selection import Selection
from cartwheel.errors import Diagnostic, Origin

ABSENT = frozenset({FILE_MISSING, FILE_ON_NETWORK})
"""Codes for files, models and packages that do not exist locally."""
GAZEBO_STEP = 0.001
"""Default time step, s."""
MOST_FOLDERS = 10_000
"""Maximum number of folders that are searched for worlds and settings."""


@dataclass(kw_only=True)
class Subject:
    """A description to check."""

    root: Node
    """The expanded tree as written; no element is marked as used."""
    files: Sequence[str]
    """All files that xacro read, starting with the given one."""
    packages: Packages
    find_launches: Callable[[], OwnLaunches]
    """Returns the launch files of the description's author."""
    read: RobotDescription | WorldDescription | None = None
    """None if the description could not be read."""
    robots: tuple[Robot, ...] = ()
    failures: tuple[Diagnostic, ...] = ()
    """Errors that prevented reading, except those that have their own rule."""
    gaps: Sequence[Origin] = ()
    """Origins of elements that lost an unreadable child, and of their parents."""
    control: Sequence[tuple[Robot, ControlFile]] = ()
    """Controller files of each robot."""
    launched: Sequence[tuple[Robot, Selection]] = ()
    """What launch files load for each robot with a controller manager; empty if the user states the
    controller files."""

    unexpanded: Sequence[Diagnostic] = ()
    """About a launch file that does not expand the description."""
    arguments: Mapping[str, str] = field(default_factory=dict)
    """Arguments of the xacro, including defaults."""
    find_unread: Callable[[], Sequence[Diagnostic]] = tuple
    """Returns what was not read of the launch files that were searched."""

    @property
    def is_urdf(self) -> bool:
        """Whether it is a URDF or a xacro that produces one."""
        return self.root.tag == "robot"

    @cached_property
    def simulator(self) -> Simulator:
        """The version of Gazebo that the plugins are for; empty for none or both."""
        return simulator_of(self.root)

    def in_sdf(self, origin: Origin | None) -> bool:
        """Whether the element with this origin is written in SDF."""
        return not self.is_urdf or id(origin) in self._inserted

    @cached_property
    def _inserted(self) -> frozenset[int]:
        """Elements in a ``<gazebo>`` without a reference, by the id of their origin."""
        tags = nodes.children(self.root, "gazebo")
        whole = [tag for tag in tags if not nodes.text_of(tag, "reference")]
        return frozenset(id(node.origin) for tag in whole for node in nodes.walk(tag))

    @cached_property
    def written(self) -> tuple[Node, ...]:
        """Each readable xacro file before expansion."""
        trees = (xml.readable_file(Path(file)) for file in self.files)
        return tuple(tree for tree in trees if tree is not None)

    @cached_property
    def launch(self) -> LaunchUse | None:
        """The launch file that starts the description, if there is one."""
        return chosen(Path(self.files[0]), self.own_launches.launches)

    @cached_property
    def own_launches(self) -> OwnLaunches:
        """The launch files of the description's author."""
        return self.find_launches()

    @cached_property
    def own_folders(self) -> Sequence[tuple[Path, list[str]]]:
        """The folders of the description's author, each with the names of its files.

        There are at most `MOST_FOLDERS`: a file outside of a repository may be anywhere.
        """
        return list(itertools.islice(source_folders(self.own_launches.folder), MOST_FOLDERS))

    @cached_property
    def macros(self) -> frozenset[str]:
        """Names of the macros defined in its files, also without the prefix, as before Noetic."""
        return frozenset(
            nodes.name_of(node).removeprefix("xacro:")
            for tree in self.written
            for node in nodes.walk(tree)
            if node.tag in ("xacro:macro", "macro")
        )

    def node_at(self, origin: Origin | None) -> Node | None:
        """The element with exactly this origin."""
        return None if origin is None else self._at.get(id(origin))

    def holder_of(self, node: Node) -> Node | None:
        """The parent of an element."""
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
        """Names of all joints in the file, including unreadable ones."""
        return frozenset(nodes.name_of(n) for n in nodes.walk(self.root) if n.tag == "joint")

    @cached_property
    def lacks_models(self) -> bool:
        """Whether an included model is missing, so that its contents are unknown."""
        diagnostics = () if self.read is None else self.read.diagnostics
        return any(
            each.code in ABSENT
            and each.values.get("kind") == "model"
            # The meshes of a model are in its folder, but contain no joints.
            and each.values.get("left_out") not in ("visual", "collision")
            for each in diagnostics
        )

    @property
    def step(self) -> float:
        """Time step of the physics in Gazebo, s."""
        if isinstance(self.read, WorldDescription) and self.read.physics.max_step_size:
            return self.read.physics.max_step_size
        return GAZEBO_STEP


def is_known(name: str, robot: Robot, subject: Subject) -> bool:
    """Whether a joint with this name exists, with or without its scope."""
    if name in robot.joint_names or name.rpartition("::")[2] in robot.joint_names:
        return True
    if subject.is_urdf:
        return False
    return subject.lacks_models or name.rpartition("::")[2] in subject.joints_written
