"""Names of a ROS 1 node, and the ROS 1 names of the graph's topics, services and parameters."""

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
"""Topics that are never moved into a namespace."""
PRIVATE = "/gazebo/"
"""Prefix of Gazebo's own names in the graph, which become private names of the node."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Arguments:
    """The ``name:=value`` arguments of a ROS 1 node."""

    remappings: dict[str, str] = field(default_factory=dict)
    parameters: dict[str, Any] = field(default_factory=dict)
    """Private parameters: ``_name:=value``, with values parsed as YAML."""
    special: dict[str, str] = field(default_factory=dict)
    """``__name``, ``__ns``, ``__log``, ``__ip``, ``__hostname``, ``__master``."""

    @classmethod
    def parse(cls, words: Iterable[str]) -> Arguments:
        """Parses the arguments.

        Raises:
            CartwheelError: An argument does not have the form ``name:=value``.
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
    """Name of a node, and its remapping of other names.

    Args:
        node: Name of the node, unless ``__name:=`` overrides it.
        arguments: See `Arguments`.

    Raises:
        CartwheelError: ROS does not accept a name.
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
        """Full name of the node, with namespace."""
        self._remappings = {
            self._resolved(name): self._resolved(value)
            for name, value in arguments.remappings.items()
        }

    def outer(self, name: str) -> str:
        """ROS 1 name of a topic or service in the graph."""
        if name.startswith(PRIVATE):
            full = f"{self.node}/{name.removeprefix(PRIVATE)}"
        elif name in GLOBAL:
            full = name
        else:
            full = _join(self.namespace, name)
        return self._remappings.get(full, full)

    def parameter(self, name: str) -> str:
        """ROS 1 name of a parameter. Gazebo's parameters become private names of the node."""
        return f"{self.node}/{name.removeprefix(PRIVATE)}" if name.startswith(PRIVATE) else name

    def private(self, name: str) -> str:
        """Full name of ``~name``."""
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
