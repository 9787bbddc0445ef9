"""A configuration of ros_gz_bridge: names and types that new Gazebo's topics have in ROS."""

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
"""What is published beside an image, under its name."""


def gz_topic(name: str) -> str:
    """A topic of new Gazebo's in ROS's letters: there it may hold dashes, and begin with digits."""
    parts = [re.sub(r"\W", "_", part, flags=re.ASCII) for part in name.strip("/").split("/")]
    return "".join(f"/_{part}" if part[:1].isdigit() else f"/{part}" for part in parts)


@dataclass(frozen=True, kw_only=True, slots=True)
class Bridged:
    """One entry: a topic of Gazebo's, and what ROS knows of it."""

    gz: str
    ros: str
    type: str
    """Of its messages in ROS, ``pkg/msg/Name``."""
    origin: Origin


class GzBridge:
    """The topics of a graph that have names of their own in ROS.

    Plugins ask it where to publish and to read, so that the graph is the one that the bridge makes.
    """

    def __init__(self) -> None:
        self._entries: dict[str, Bridged] = {}
        self._asked: dict[str, str] = {}
        """The types of what plugins asked for, by Gazebo's names."""
        self._faults: list[Diagnostic] = []

    @classmethod
    def of(cls, graph: Graph) -> GzBridge:
        """That of a graph, empty at first."""
        found = _BY_GRAPH.get(graph)
        if found is None:
            found = _BY_GRAPH[graph] = cls()
        return found

    def add(self, entries: Iterable[Bridged]) -> None:
        """Takes what a file says; of two names for one topic the first counts."""
        for entry in entries:
            first = self._entries.setdefault(entry.gz, entry)
            if first.ros != entry.ros:
                reason = f'"{entry.gz}" is published as {first.ros} already'
                self._faults.append(_warning(entry, f"{entry.ros} has no effect: {reason}"))

    def published(self, name: str, type_name: str) -> str:
        """What ROS calls a topic that a plugin publishes."""
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
        """What ROS calls a topic that a plugin reads, its type there, and who takes its messages.

        A type that is the plugin's own with a header, as TwistStamped is Twist's, is unpacked.
        """
        entry = self._entry(name, type_name)
        if entry is None:
            return name, type_name, callback
        inside = _inside(entry.type, type_name)
        if inside is None:
            return entry.ros, type_name, callback
        return entry.ros, entry.type, lambda message: callback(getattr(message, inside))

    def faults(self, topics: Collection[str]) -> Iterator[Diagnostic]:
        """What the files say and does nothing here.

        Args:
            topics: Names of all that there are.
        """
        yield from self._faults
        for entry in self._entries.values():
            own = self._asked.get(entry.gz)
            if own is None and entry.gz not in topics and entry.type != CLOCK:
                message = f'no plugin publishes or reads "{entry.gz}", so {entry.ros} has no effect'
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
    """The field of a stamped message that is the message itself."""
    if outer != f"{inner}Stamped":
        return None
    return next((field.name for field in fields(outer) if field.type == inner), None)


def read_bridge(path: Path) -> list[Bridged]:
    """The entries of a file for ``parameter_bridge``.

    Raises:
        CartwheelError: It cannot be read, is no YAML, or holds no list of topics; with its place.
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
            "Name the file that the parameter config_file of ros_gz_bridge names.",
        )
    return [_bridged(entry, Origin(file=str(path), line=line)) for entry, line in entries]


def _entries(loader: Any, root: Any) -> list[tuple[Any, int]] | None:
    """A list's entries with their lines; None where it is no list."""
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
    # As the bridge: where one of the two is missing, they are the same.
    ros, gz = ros or gz, gz or ros
    kind = entry.get("ros_type_name")
    if not isinstance(gz, str) or not isinstance(ros, str) or not isinstance(kind, str):
        raise _invalid("an entry needs ros_topic_name, gz_topic_name and ros_type_name", origin)
    try:
        name = resolve_name(ros)
    except GraphError as error:
        hint = "If a launch file fills the name in, write the result into a copy of the file."
        raise _invalid(error.message, origin, hint) from None
    return Bridged(gz=gz_topic(gz), ros=name, type=type_name(kind), origin=origin)
