"""A ROS 1 node's name, and what the names of the graph are called under it."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

import yaml

from cartwheel import yaml_text
from cartwheel.codes.wires import ROS_ARGUMENT_INVALID, ROS_NODE_NAME_INVALID
from cartwheel.errors import CartwheelError

_BASE = re.compile(r"[A-Za-z][A-Za-z0-9_]*\Z")
_NAME = re.compile(r"[~/]?(?:[A-Za-z][A-Za-z0-9_]*/)*(?:[A-Za-z][A-Za-z0-9_]*)?\Z")

GLOBAL = ("/clock", "/tf", "/tf_static", "/rosout")
"""Topics that no namespace moves."""
PRIVATE = "/gazebo/"
"""The graph's names of what is Gazebo's own: private names of its node."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Arguments:
    """The ``name:=value`` of a command line, as every ROS 1 node takes them."""

    remappings: dict[str, str] = field(default_factory=dict)
    parameters: dict[str, Any] = field(default_factory=dict)
    """Private ones: ``_name:=value``, the value read as YAML."""
    special: dict[str, str] = field(default_factory=dict)
    """``__name``, ``__ns``, ``__log``, ``__ip``, ``__hostname``, ``__master``."""

    @classmethod
    def parse(cls, words: Iterable[str]) -> Arguments:
        """Reads them.

        Raises:
            CartwheelError: A word is no ``name:=value``.
        """
        made = cls()
        for word in words:
            name, sign, value = word.partition(":=")
            if not sign or not name:
                raise CartwheelError(
                    f'"{word}" is not of the form name:=value',
                    code=ROS_ARGUMENT_INVALID,
                    values={"argument": word},
                )
            if name.startswith("__"):
                made.special[name] = value
            elif name.startswith("_"):
                made.parameters[name[1:]] = _yaml(value)
            else:
                made.remappings[name] = value
        return made


class NodeNames:
    """What a node is called and what it calls others.

    Args:
        node: Its name, unless ``__name:=`` gives another.
        arguments: See `Arguments`.

    Raises:
        CartwheelError: A name is none that ROS accepts.
    """

    def __init__(self, node: str, arguments: Arguments) -> None:
        special = arguments.special
        base = special.get("__name", node)
        space = special.get("__ns", os.environ.get("ROS_NAMESPACE", ""))
        if base.startswith("/") and base.count("/") == 1:
            base = base[1:]
        if not _BASE.match(base):
            raise CartwheelError(
                f'"{base}" is not a valid name for a ROS node',
                code=ROS_NODE_NAME_INVALID,
                hint="Names may contain letters, digits and _, and must begin with a letter.",
                values={"name": base},
            )
        self.namespace = "/" + "/".join(part for part in space.split("/") if part)
        if not _NAME.match(self.namespace):
            raise CartwheelError(
                f'"{space}" is not a valid ROS namespace',
                code=ROS_NODE_NAME_INVALID,
                values={"name": space},
            )
        self.node = _join(self.namespace, base)
        """With its namespace."""
        self._remappings = {
            self._resolved(name): self._resolved(value)
            for name, value in arguments.remappings.items()
        }

    def outer(self, name: str) -> str:
        """ROS's name of a topic or service of the graph."""
        if name.startswith(PRIVATE):
            full = f"{self.node}/{name.removeprefix(PRIVATE)}"
        elif name in GLOBAL:
            full = name
        else:
            full = _join(self.namespace, name)
        return self._remappings.get(full, full)

    def parameter(self, name: str) -> str:
        """ROS's name of a parameter of the graph: Gazebo's own are private ones of its node."""
        return f"{self.node}/{name.removeprefix(PRIVATE)}" if name.startswith(PRIVATE) else name

    def private(self, name: str) -> str:
        """The full name of ``~name``."""
        return f"{self.node}/{name}"

    def _resolved(self, name: str) -> str:
        if not _NAME.match(name) or not name:
            raise CartwheelError(
                f'"{name}" cannot be remapped: it is not a valid ROS name',
                code=ROS_ARGUMENT_INVALID,
                values={"name": name},
            )
        if name.startswith("/"):
            return "/" + name.strip("/")
        if name.startswith("~"):
            return self.private(name[1:].strip("/"))
        return _join(self.namespace, name)


def _join(namespace: str, name: str) -> str:
    return f"{namespace.rstrip('/')}/{name.strip('/')}"


def _yaml(text: str) -> Any:
    try:
        return yaml_text.load(text)
    except yaml.YAMLError:
        return text
