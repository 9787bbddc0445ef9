"""Controller parameter files, parsed so that each value has a line number."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from cartwheel import yaml_text
from cartwheel.checks import nodes
from cartwheel.codes import devices as devices_codes
from cartwheel.description.elements.xml import shown_path
from cartwheel.description.launches.written import written_in
from cartwheel.description.model import Element, RobotDescription
from cartwheel.dialects.ros_control.files import read_parameters
from cartwheel.dialects.ros_control.launch_arguments import launch_arguments, with_arguments
from cartwheel.dialects.ros_control.launched.names import shared_space
from cartwheel.errors import Diagnostic, Origin, PluginError

_MAX_BYTES = 1_000_000
_ROS2 = "ros__parameters"
_MERGE = "tag:yaml.org,2002:merge"
"""The tag of the key ``<<``."""
_DEEPEST = 4
"""Maximum nesting of namespaces around a ROS 1 controller."""


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Value:
    """A scalar in a file."""

    text: str
    file: ControlFile
    node: Any

    @property
    def origin(self) -> Origin:
        """The value's file and line."""
        return self.file.origin(self.node)

    @property
    def number(self) -> float | None:
        """The value if it is a finite number, otherwise None."""
        return nodes.number(self.text)

    def replaced(self, text: str) -> str:
        """The source line with the value replaced, without indentation."""
        start, end = self.node.start_mark, self.node.end_mark
        line = self.file.lines[start.line]
        last: int = end.column if end.line == start.line else len(line)
        before, after = line[: start.column], line[last:]
        return f"{before}{text}{after}".strip()


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Controller:
    """The parameters of one controller."""

    name: str
    type: Value
    parameters: tuple[Any, ...]
    """Parameter mappings; later mappings extend earlier ones."""
    file: ControlFile

    @property
    def kind(self) -> str:
        """The controller type as ``package/Class``."""
        text: str = self.type.text
        return text.strip().replace("::", "/")

    def node(self, path: str) -> Any:
        """The node at a path with slashes; dots in ROS 2 parameter names are supported."""
        for mapping in reversed(self.parameters):
            found = _find(mapping, path.split("/"))
            if found is not None:
                return found
        return None

    def value(self, *paths: str) -> Value | None:
        """The first scalar at any of these paths."""
        for path in paths:
            node = self.node(path)
            if node is not None and node.id == "scalar":
                return Value(text=node.value, file=self.file, node=node)
        return None

    def values(self, *paths: str) -> list[Value]:
        """The scalars of the first of these lists that is present; a scalar is a list of one."""
        for path in paths:
            node = self.node(path)
            if node is not None and node.id in ("scalar", "sequence"):
                held = node.value if node.id == "sequence" else [node]
                return [
                    Value(text=one.value, file=self.file, node=one)
                    for one in held
                    if one.id == "scalar"
                ]
        return []

    def has(self, path: str) -> bool:
        """Whether the path exists."""
        return self.node(path) is not None


def _start_of(path: Path) -> str:
    """The beginning of a file, up to the size limit; of a launch file, its parameters."""
    if (written := written_in(path)) is not None:
        return written
    with path.open("rb") as file:
        return file.read(_MAX_BYTES).decode("utf-8", "replace")


@dataclass(kw_only=True, eq=False)
class ControlFile:
    """A file with controller parameters."""

    path: Path
    named: bool
    """Whether the robot or the user refers to the file; otherwise it was found near the robot."""
    element: Element | None = None
    """The tag that refers to the file."""
    robot: RobotDescription | None = None
    """The robot whose arguments replace ``$(arg name)`` in the file."""
    name: str = ""
    """The name of the only controller in the file, which a launch file states; empty for that of
    the file."""
    used: frozenset[str] = frozenset()
    """Names of the controllers that launch files start or load; empty if they are unknown."""

    @cached_property
    def lines(self) -> list[str]:
        """The lines of the file."""
        try:
            return _start_of(self.path).splitlines()
        except OSError:
            return []

    @cached_property
    def root(self) -> Any:
        """The root node; None if the file is empty or has a `problem`."""
        return None if isinstance(self._composed, Diagnostic) else self._composed

    @property
    def problem(self) -> Diagnostic | None:
        """Why the file cannot be read, or None."""
        return self._composed if isinstance(self._composed, Diagnostic) else None

    @cached_property
    def is_ros2(self) -> bool:
        """Whether the file contains ROS 2 node parameters."""
        return any(True for _ in _ros2_nodes(self.root, ()))

    @cached_property
    def controllers(self) -> tuple[Controller, ...]:
        """The controllers that may run: all that are written, unless launch files select some."""
        return tuple(each for each in self.written if not self.used or each.name in self.used)

    @cached_property
    def written(self) -> tuple[Controller, ...]:
        """All controllers with a type."""
        if self.is_ros2:
            return tuple(self._of_ros2())
        # The file may hold a single controller, whose name is set by a launch file.
        one = self._controller(self.name or self.path.stem, self.root)
        return (one,) if one is not None else tuple(self._named())

    def words(self, *path: str) -> list[str]:
        """The texts of a list at a path, also in a namespace."""
        roots = [self.root, *(value for _, value in pairs(self.root))]
        lists = [_find(root, list(path)) for root in roots]
        return [
            one.value
            for node in lists
            if node is not None and node.id == "sequence"
            for one in node.value
            if one.id == "scalar"
        ]

    def origin(self, node: Any) -> Origin:
        """The line of a node."""
        return Origin(file=shown_path(self.path), line=node.start_mark.line + 1)

    @cached_property
    def _composed(self) -> Any:
        # Import yaml only for robots with controllers: the import is slow.
        import yaml

        try:
            text = _start_of(self.path)
            root = yaml.compose(text, Loader=yaml_text.loader())
        except (OSError, yaml.YAMLError) as error:
            mark = getattr(error, "problem_mark", None)
            problem = getattr(error, "problem", None) or getattr(error, "strerror", None) or error
            return devices_codes.CONTROLLERS_FILE_UNREADABLE.diagnostic(
                message=f"the controller file cannot be read: {problem}",
                values={"problem": str(problem)},
                origin=Origin(
                    file=shown_path(self.path), line=mark.line + 1 if mark is not None else 0
                ),
            )
        # The elements of a launch file are merged as well.
        written = self.path.suffix not in (".yaml", ".yml")
        if root is not None and (_ROS2 in text or written):
            yaml_text.as_ros2(root)
        if root is not None and self.robot is not None and "$(" in text:
            self._fill(root, self.robot)
        return root

    def _fill(self, root: Any, robot: RobotDescription) -> None:
        """Replaces the arguments in the file, as when the controllers are loaded."""
        try:
            arguments = launch_arguments(read_parameters(self.path), robot)
        except PluginError:
            arguments = dict(robot.arguments)
        for node in _scalars(root):
            node.value = with_arguments(node.value, arguments)

    def _named(self) -> Iterator[Controller]:
        """ROS 1's controllers, with their names below the namespace that they share."""
        found = list(self._of_ros1(self.root, ()))
        space = shared_space([path for path, _ in found])
        for path, node in found:
            controller = self._controller("/".join(path[len(space) :]), node)
            if controller is not None:
                yield controller

    def _of_ros1(self, node: Any, path: tuple[str, ...]) -> Iterator[tuple[tuple[str, ...], Any]]:
        for key, value in pairs(node):
            if value.id != "mapping":
                continue
            inner = (*path, *(part for part in key.value.split("/") if part))
            if self._controller("", value) is not None:
                yield inner, value
            elif len(path) < _DEEPEST:
                yield from self._of_ros1(value, inner)

    def _controller(self, name: str, node: Any) -> Controller | None:
        """Reads a mapping as a ROS 1 controller; None if it has no controller type."""
        kind = _find(node, ["type"]) if node is not None else None
        if kind is None or kind.id != "scalar" or "/" not in kind.value.replace("::", "/"):
            return None
        return Controller(
            name=name,
            type=Value(text=kind.value, file=self, node=kind),
            parameters=(node,),
            file=self,
        )

    def _of_ros2(self) -> Iterator[Controller]:
        types: dict[str, Any] = {}
        parameters: dict[str, list[Any]] = {}
        for path, values in _ros2_nodes(self.root, ()):
            name = path[-1] if path else "**"
            parameters.setdefault(name, []).append(values)
            for key, value in pairs(values):
                kind = _find(value, ["type"])
                if kind is not None and kind.id == "scalar" and "/" in kind.value:
                    types.setdefault(key.value, kind)
            own = _find(values, ["type"])
            if own is not None and own.id == "scalar" and "/" in own.value:
                types.setdefault(name, own)
        for name, kind in types.items():
            yield Controller(
                name=name,
                type=Value(text=kind.value, file=self, node=kind),
                parameters=(*parameters.get("**", ()), *parameters.get(name, ())),
                file=self,
            )


def _scalars(root: Any) -> Iterator[Any]:
    """All scalars in a tree, each once: aliases lead to the same node several times."""
    seen: set[int] = set()
    waiting = [root]
    while waiting:
        node = waiting.pop()
        if id(node) in seen:
            continue
        seen.add(id(node))
        if node.id == "scalar":
            yield node
        elif node.id == "sequence":
            waiting += node.value
        else:
            waiting += (part for pair in node.value for part in pair)


def pairs(node: Any) -> list[tuple[Any, Any]]:
    """The key-value pairs of a mapping; empty for any other node.

    Of a repeated key, the last one counts, as in ROS. In a file of ROS 2, mappings with the same
    key are already merged.
    """
    return list({key.value: (key, value) for key, value in _all_pairs(node)}.values())


def repeated_keys(node: Any) -> Iterator[tuple[Any, Any]]:
    """Each key that a later one in the same mapping replaces, with the later one.

    Args:
        node: A node, or None; its mappings are searched at any depth.
    """
    remaining, seen = [node], set[int]()
    while remaining:
        one = remaining.pop()
        if one is None or id(one) in seen or one.id == "scalar":
            continue
        seen.add(id(one))
        if one.id == "sequence":
            remaining += one.value
            continue
        last = {key.value: key for key, _ in _all_pairs(one)}
        for key, value in _all_pairs(one):
            # A mapping may merge several others.
            if key is not last[key.value] and key.tag != _MERGE:
                yield key, last[key.value]
            remaining.append(value)


def _all_pairs(node: Any) -> list[tuple[Any, Any]]:
    if node is None or node.id != "mapping":
        return []
    return [(key, value) for key, value in node.value if key.id == "scalar"]


def _find(node: Any, words: list[str]) -> Any:
    """The node at a path; dots in keys may join several path elements."""
    if not words:
        return node
    for count in range(1, len(words) + 1):
        name = ".".join(words[:count])
        for key, value in pairs(node):
            if key.value == name:
                found = _find(value, words[count:])
                if found is not None:
                    return found
    return None


def _ros2_nodes(node: Any, path: tuple[str, ...]) -> Iterator[tuple[tuple[str, ...], Any]]:
    for key, value in pairs(node):
        if key.value == _ROS2:
            yield path, value
            continue
        words = tuple(word for word in key.value.split("/") if word)
        if len(path) <= _DEEPEST:
            yield from _ros2_nodes(value, (*path, *words))
