"""Reads launch files in XML: those of roslaunch (ROS 1) and of launch_xml (ROS 2)."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

from cartwheel.description.elements import xml
from cartwheel.description.elements.node import Node
from cartwheel.description.expressions import Function
from cartwheel.description.files.other_places import is_in_home
from cartwheel.description.launches.bridging import BRIDGES
from cartwheel.description.launches.effort import UNKNOWN, limited
from cartwheel.description.launches.environment import ros_variable
from cartwheel.description.launches.evaluation import evaluated
from cartwheel.description.launches.launch_use import Unfound
from cartwheel.description.launches.spawning import resolved, split
from cartwheel.description.launches.use import Facts
from cartwheel.description.launches.written import has_controllers

_CALL = re.compile(r"\$\(\s*+([\w-]++)\s*+([^()]*+)\)")
"""Without backtracking, whose time would grow with the square of the length."""
_EVAL = re.compile(r"\$\(\s*eval\s(.*)\)\s*", re.DOTALL)
_FALSE = frozenset({"false", "0", "False"})


def read_xml(path: Path, arguments: Mapping[str, str], facts: Facts, depth: int) -> None:
    """Adds the contents of a launch file to `facts`."""
    root = xml.readable_file(path)
    if root is not None and root.tag == "launch":
        _Reader(path, dict(arguments), facts, depth).group(root)


class _UnknownError(Exception):
    """A value that only the execution of the launch file determines."""


class _Reader:
    def __init__(self, path: Path, given: dict[str, str], facts: Facts, depth: int) -> None:
        self._path = path
        self._given = given
        self._arguments = dict(given)
        self._facts = facts
        self._depth = depth
        self._inside_node = False
        self._line = 0
        """The line of the attribute that is being evaluated."""

    def group(self, node: Node) -> None:
        """Reads the elements of a launch file or of a ``<group>``."""
        for child in node.children:
            self._facts.effort.spend()
            if self._holds(child):
                self._element(child)

    def _element(self, node: Node) -> None:
        facts = self._facts
        tag = node.tag
        if tag in ("arg", "let"):
            self._argument(node)
        elif tag == "group":
            with facts.within(self._space(node)):
                self.group(node)
        elif tag in ("push_ros_namespace", "push-ros-namespace"):
            facts.namespace = self._space(node)
        elif tag == "include":
            given = {
                child.attributes.get("name", ""): self._given_value(child)
                for child in node.children
                if child.tag in ("arg", "let") and self._may_hold(child)
            }
            if node.attributes.get("pass_all_args") == "true":
                self._facts.effort.spend(len(self._arguments))
                given = {**self._arguments, **given}
            file = self._value(node, "file")
            # In ROS 2, files inherit the arguments of those that include them.
            stated = node.attributes.get("file", "")
            near = "dirname" in stated and file.endswith(".launch.xml")
            is_ros2 = near or file.endswith(".py") or "find-pkg-share" in stated
            with facts.within(self._space(node)):
                inherited = self._arguments if is_ros2 else {}
                places = {
                    child.attributes.get("name", ""): child.origin
                    for child in node.children
                    if child.tag in ("arg", "let")
                }
                facts.include(
                    file, given, self._depth, inherited, origin=node.origin, places=places
                )
        elif tag == "param":
            self._parameter(node)
        elif tag == "rosparam":
            if node.attributes.get("command", "load") == "load" and "file" in node.attributes:
                # In a node, they are parameters of this node.
                certain = not self._inside_node and "param" not in node.attributes
                space = self._value(node, "ns")
                facts.parameters(self._value(node, "file"), space, certain=certain)
                facts.need("parameters", self._value(node, "file"), node.origin)
                if certain:
                    self._find(node, space)
            elif node.attributes.get("command", "load") == "load" and has_controllers(node.text):
                facts.written(self._path, self._value(node, "ns"))
        elif tag == "ros_gz_bridge":
            facts.bridge(self._value(node, "config_file"))
        elif tag == "executable":
            facts.command(split(self._value(node, "cmd")), node.origin)
        elif tag == "node":
            kind = "exec" if "exec" in node.attributes else "type"
            package = self._value(node, "pkg")
            facts.node(
                package,
                self._value(node, kind),
                split(self._value(node, "args")),
                self._space(node),
                remappings={
                    self._value(child, "from"): self._value(child, "to")
                    for child in node.children
                    if child.tag == "remap" and self._holds(child)
                },
                values={
                    child.attributes.get("name", ""): self._value(child, "value")
                    for child in node.children
                    if child.tag == "param" and "value" in child.attributes and self._holds(child)
                },
                origin=node.origin,
                name=self._value(node, "name"),
            )
            if kind == "type" and package == "controller_manager":
                facts.seek(split(self._value(node, "args")), self._space(node))
            outer, self._inside_node = self._inside_node, True
            with facts.within(self._space(node)):
                self.group(node)
            self._inside_node = outer
            for child in node.children if package in BRIDGES else ():
                named = child.attributes.get("name") if child.tag == "param" else None
                if named == "config_file" and self._holds(child):
                    facts.bridge(self._value(child, "value"))

    def _find(self, node: Node, space: str) -> None:
        """Notes the file of a ``<rosparam>`` if it is missing: one with the parameters of a single
        controller, one in a home folder, or one of a package that was not found.
        """
        stated = node.attributes["file"]
        packages = [words for kind, words in _CALL.findall(stated) if kind == "find"]
        path, name = Path(self._value(node, "file").strip()), space.strip("/ ").rpartition("/")[2]
        known = path in self._facts.lost and len(packages) == stated.count("$") == 1
        absent = {f'package "{each.strip()}"' for each in packages} & self._facts.absent.keys()
        if absent and path in self._facts.lost:
            self._facts.foreign[path] = None
        found = known and not absent
        moved = path in self._facts.lost and is_in_home(stated.strip())
        if moved or (found and re.fullmatch(r"\w+", name)):
            name = "" if moved else name
            self._facts.unfound.append(Unfound(controller=name, file=path, origin=node.origin))

    def _space(self, node: Node) -> str:
        """The namespace of an element."""
        stated = self._value(node, "ns") or self._value(node, "namespace")
        return resolved(self._facts.namespace, stated)

    def _argument(self, node: Node) -> None:
        name = node.attributes.get("name", "")
        if not self._depth and "value" not in node.attributes:
            self._facts.declared.add(name)
        if "value" in node.attributes:
            self._arguments[name] = self._value(node, "value")
        elif name not in self._given and "default" in node.attributes:
            self._arguments[name] = self._value(node, "default")
            if not self._depth:
                self._facts.defaults[name] = self._arguments[name]
                choices = [each for each in node.children if each.tag == "choice"]
                if choices:
                    values = (each.attributes.get("value", "") for each in choices)
                    self._facts.choices[name] = tuple(values)
        elif name not in self._arguments:
            self._facts.required[self._path, name] = node.origin

    def _given_value(self, node: Node) -> str:
        """The argument for an included file. roslaunch accepts a default as well as a value."""
        if self._facts.strict and self._condition(node) is None:
            return UNKNOWN
        return self._value(node, "value" if "value" in node.attributes else "default")

    def _parameter(self, node: Node) -> None:
        facts = self._facts
        if "from" in node.attributes:
            facts.parameters(self._value(node, "from"))
        if facts.strict:
            self._need(node)
        parameter = self._value(node, "name")
        if not parameter.endswith("description"):
            stated = next((name for name in ("command", "textfile") if name in node.attributes), "")
            if stated and not self._inside_node:
                key = resolved(facts.namespace, parameter)
                facts.unread[key] = partial(self._described, node, stated)
            return
        for name in ("command", "textfile", "value"):
            value = node.attributes.get(name, "")
            if value and (name != "value" or "command" in value):
                facts.store_parameter(parameter, self._described(node, name))

    def _need(self, node: Node) -> None:
        """Notes the files that ROS reads for a parameter."""
        self._facts.need("file", self._value(node, "textfile"), node.origin)
        # In ROS 2, the command is a substitution.
        name = "value" if "command" in node.attributes.get("value", "") else "command"
        self._facts.need_text(split(self._value(node, name)), node.origin)

    def _described(self, node: Node, name: str) -> int | None:
        """Adds the description that an attribute states; its number as for `Facts.describe`."""
        return self._facts.describe(self._value(node, name), node.origin)

    def _holds(self, node: Node) -> bool:
        """Whether the conditions of an element hold. An unknown condition holds, unless only what
        is certain counts.
        """
        holds = self._condition(node)
        if holds is None and self._facts.strict:
            if node.tag in ("arg", "let"):
                self._arguments[node.attributes.get("name", "")] = UNKNOWN
            return False
        return holds is not False

    def _may_hold(self, node: Node) -> bool:
        """Whether the conditions of an element hold or are unknown."""
        return self._condition(node) is not False

    def _condition(self, node: Node) -> bool | None:
        """Whether the conditions of an element hold; None if one of them is unknown."""
        known = True
        for name, wanted in (("if", True), ("unless", False)):
            if name in node.attributes:
                value = self._value(node, name).strip()
                if UNKNOWN in value:
                    known = False
                elif (value not in _FALSE) is not wanted:
                    self._facts.leaves_out = True
                    return False
        return True if known else None

    def _value(self, node: Node, name: str) -> str:
        text = limited(node.attributes.get(name, ""))
        self._line = node.origin.line
        self._facts.effort.spend(1 + len(text))
        # As in roslaunch, the parentheses of an expression end at the end of the attribute.
        expression = _EVAL.fullmatch(text)
        if expression is not None and "$(" not in expression[1]:
            return self._evaluated(expression[1])
        for _ in range(20):
            found = _CALL.search(text)
            if found is None:
                break
            value = self._call(found[1], found[2].strip())
            text = limited(text[: found.start()] + value + text[found.end() :])
            self._facts.effort.spend(len(text))
        # What is left is an expression with parentheses within a text.
        return "\n".join(map(_without_calls, text.split("\n")))

    def _call(self, kind: str, rest: str) -> str:
        """The value of ``$(kind rest)``."""
        words = rest.split(None, 1)
        first = words[0] if words else ""
        if kind in ("arg", "var"):
            value = self._arguments.get(first, UNKNOWN)
            # Some launch files state an empty default for what the user must state.
            return value or UNKNOWN if self._facts.strict else value
        if kind in ("find", "find-pkg-share"):
            return self._facts.package(first)
        if kind in ("env", "optenv"):
            # Without a default, a variable that is not set is empty.
            ros = self._ros(first)
            if ros is not None:
                return ros
            absent = "" if kind == "optenv" else UNKNOWN
            if self._facts.strict:
                return UNKNOWN
            return os.environ.get(first, words[1] if len(words) > 1 else absent)
        if kind == "dirname":
            return str(self._path.parent)
        if kind == "command":
            return rest.strip("'\"")
        if kind == "eval" and UNKNOWN not in rest:
            quoted = len(rest) > 1 and rest[0] == rest[-1] and rest[0] in "'\""
            return self._evaluated(rest[1:-1] if quoted and rest[0] not in rest[1:-1] else rest)
        return UNKNOWN

    def _evaluated(self, text: str) -> str:
        """The value of an expression; the names are those of arguments, as in roslaunch."""
        functions: Mapping[str, Callable[..., Any]] = {
            "arg": self._known,
            "find": lambda name: _certain(self._facts.package(name)),
            "env": lambda name: self._ros(name) or self._variables()[name],
            "optenv": lambda name, default="": (
                self._ros(name) or self._variables().get(name, default)
            ),
            "dirname": lambda: str(self._path.parent),
        }
        self._facts.effort.spend(len(self._arguments))
        names: dict[str, Any] = {}
        for name, value in self._arguments.items():
            if UNKNOWN not in value:
                names[name] = _converted(value)
        for name, plain in functions.items():
            names[name] = Function(name, lambda _, *args, plain=plain: plain(*args))
        return evaluated(text, names, self._facts.effort)

    def _variables(self) -> Mapping[str, str]:
        """The environment, which is unknown on other computers."""
        if self._facts.strict:
            raise _UnknownError
        return os.environ

    def _ros(self, name: Any) -> str | None:
        """The value of an environment variable that ROS sets; None for any other one."""
        return ros_variable(name, self._path, self._line, self._facts)

    def _known(self, name: str) -> Any:
        return _converted(_certain(self._arguments.get(name, UNKNOWN)))


def _without_calls(line: str) -> str:
    """A line in which the text from the first ``$(`` to the last ``)`` is unknown."""
    begin, end = line.find("$("), line.rfind(")")
    return f"{line[:begin]}{UNKNOWN}{line[end + 1 :]}" if 0 <= begin < end else line


def _certain(text: str) -> str:
    if UNKNOWN in text:
        raise _UnknownError
    return text


def _converted(text: str) -> Any:
    """An argument in an expression: an integer, a number or a boolean if it looks like one."""
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return {"true": True, "false": False}.get(text.lower(), text)
