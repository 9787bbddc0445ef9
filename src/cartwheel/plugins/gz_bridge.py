"""A ros_gz_bridge configuration: names and types of gz-sim's topics in ROS."""

from __future__ import annotations

import re
import weakref
from collections.abc import Callable, Collection, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from cartwheel import yaml_text
from cartwheel.codes import devices
from cartwheel.errors import CartwheelError, Diagnostic, GraphError, Origin, suggestion
from cartwheel.graph import Graph, resolve_name
from cartwheel.messages import type_name
from cartwheel.messages.fields import fields

CLOCK = "rosgraph_msgs/msg/Clock"
IMAGES = ("/compressed", "/compressedDepth")
"""Subtopics of an image."""


def gz_topic(name: str) -> str:
    """Converts a gz-sim topic name, which can contain dashes and leading digits, to ROS."""
    parts = [re.sub(r"\W", "_", part, flags=re.ASCII) for part in name.strip("/").split("/")]
    return "".join(f"/_{part}" if part[:1].isdigit() else f"/{part}" for part in parts)


@dataclass(frozen=True, kw_only=True, slots=True)
class Bridged:
    """One entry: a Gazebo topic, and its name and type in ROS."""

    gz: str
    ros: str
    type: str
    """Message type in ROS, ``pkg/msg/Name``."""
    origin: Origin


class GzBridge:
    """The topics of a graph that a bridge renames in ROS.

    Plugins look up the names of their topics here, so that the graph has the same topics as ROS has
    behind the bridge.
    """

    def __init__(self) -> None:
        self._entries: dict[str, Bridged] = {}
        self._asked: dict[str, str] = {}
        """Types that plugins have requested, by Gazebo topic."""
        self._faults: list[Diagnostic] = []

    @classmethod
    def of(cls, graph: Graph) -> GzBridge:
        """Returns the bridge of a graph. It is empty initially."""
        bridge = _BY_GRAPH.get(graph)
        if bridge is None:
            bridge = _BY_GRAPH[graph] = cls()
        return bridge

    def add(self, entries: Iterable[Bridged]) -> None:
        """Adds the entries of a file. If a topic has several names, the first one is used."""
        for entry in entries:
            first = self._entries.setdefault(entry.gz, entry)
            if first.ros != entry.ros:
                reason = f'"{entry.gz}" is already published as {first.ros}'
                self._faults.append(_warning(entry, f"{entry.ros} has no effect: {reason}"))

    def published(self, name: str, type_name: str) -> str:
        """Returns the ROS name of a topic that a plugin publishes."""
        entry = self._entry(name, type_name)
        if entry is not None:
            return entry.ros
        for last in IMAGES:
            image = self._entries.get(name.removesuffix(last))
            if name.endswith(last) and image is not None:
                return f"{image.ros}{last}"
        return name

    def read(
        self, name: str, type_name: str, callback: Callable[[Any], None]
    ) -> tuple[str, str, Callable[[Any], None]]:
        """Returns the ROS name, type and callback for a topic that a plugin subscribes to.

        A type that adds a header to the plugin's type, such as TwistStamped to Twist, is unwrapped.
        """
        entry = self._entry(name, type_name)
        if entry is None:
            return name, type_name, callback
        inside = _inside(entry.type, type_name)
        if inside is None:
            return entry.ros, type_name, callback
        return entry.ros, entry.type, lambda message: callback(getattr(message, inside))

    def faults(self, topics: Collection[str]) -> Iterator[Diagnostic]:
        """Yields warnings about entries that have no effect.

        Args:
            topics: Names of all topics in the graph.
        """
        yield from self._faults
        for entry in self._entries.values():
            own = self._asked.get(entry.gz)
            if own is None and entry.gz not in topics and entry.type != CLOCK:
                message = f'no plugin uses the topic "{entry.gz}", so {entry.ros} has no effect'
                yield _warning(entry, message, suggestion(entry.gz, sorted(self._asked)))
            elif own is not None and own != entry.type and _inside(entry.type, own) is None:
                yield _warning(entry, f"{entry.ros} must have the type {own} (got {entry.type})")

    def _entry(self, name: str, type_name: str) -> Bridged | None:
        self._asked[name] = type_name
        return self._entries.get(name)


_BY_GRAPH: weakref.WeakKeyDictionary[Graph, GzBridge] = weakref.WeakKeyDictionary()


def _warning(entry: Bridged, message: str, hint: str = "") -> Diagnostic:
    return devices.BRIDGE_ENTRY_IGNORED.diagnostic(
        message, origin=entry.origin, hint=hint, values={"gz": entry.gz, "ros": entry.ros}
    )


def _inside(outer: str, inner: str) -> str | None:
    """Returns the field of a stamped message that contains the inner message."""
    if outer != f"{inner}Stamped":
        return None
    return next((field.name for field in fields(outer) if field.type == inner), None)


def read_bridge(path: Path) -> list[Bridged]:
    """Reads the entries of a file for ``parameter_bridge``.

    Raises:
        CartwheelError: The file cannot be read, is not valid YAML, or is not a list of topics.
    """
    import yaml

    origin = Origin(file=str(path))
    try:
        loader = yaml_text.loader()(yaml_text.read(path))
        root = loader.get_single_node()
        entries = _entries(loader, root)
    except OSError as error:
        raise _invalid(f"the file cannot be read: {error.strerror or error}", origin) from None
    except (UnicodeDecodeError, yaml.YAMLError) as error:
        mark = getattr(error, "problem_mark", None)
        problem = getattr(error, "problem", None) or "it is not text"
        line = mark.line + 1 if mark is not None else 0
        place = Origin(file=str(path), line=line)
        raise _invalid(f"the file is not valid YAML: {problem}", place) from None
    if entries is None:
        raise _invalid(
            "the file is not a list of topics",
            origin,
            "Pass the file that ros_gz_bridge uses as config_file.",
        )
    return [_bridged(entry, Origin(file=str(path), line=line)) for entry, line in entries]


def _entries(loader: Any, root: Any) -> list[tuple[Any, int]] | None:
    """Returns the entries of a list with their lines, or None if the file is not a list."""
    if root is None or (root.id == "scalar" and not root.value):
        return []
    if root.id != "sequence":
        return None
    return [
        (loader.construct_object(node, deep=True), node.start_mark.line + 1) for node in root.value
    ]


def _invalid(message: str, origin: Origin, hint: str = "") -> CartwheelError:
    return CartwheelError(message, code=devices.BRIDGE_FILE_INVALID, origin=origin, hint=hint)


def _bridged(entry: Any, origin: Origin) -> Bridged:
    if not isinstance(entry, dict):
        raise _invalid("an entry must be a mapping", origin)
    both = entry.get("topic_name")
    ros, gz = (entry.get(f"{which}_topic_name") or both for which in ("ros", "gz"))
    # As in ros_gz_bridge, a missing name defaults to the other name.
    ros, gz = ros or gz, gz or ros
    kind = entry.get("ros_type_name")
    if not isinstance(gz, str) or not isinstance(ros, str) or not isinstance(kind, str):
        raise _invalid("an entry requires ros_topic_name, gz_topic_name and ros_type_name", origin)
    try:
        name = resolve_name(ros)
    except GraphError as error:
        hint = "If a launch file substitutes the name, write the result into a copy of the file."
        raise _invalid(error.message, origin, hint) from None
    return Bridged(gz=gz_topic(gz), ros=name, type=type_name(kind), origin=origin)
