"""Topics that have different names and types in ROS, as behind a ros_gz_bridge."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterable, Iterator
from dataclasses import dataclass
from typing import Any

from cartwheel.codes import devices
from cartwheel.errors import Diagnostic, Origin
from cartwheel.messages.fields import fields
from cartwheel.similar_names import suggestion

CLOCK = "rosgraph_msgs/msg/Clock"
IMAGES = ("/compressed", "/compressedDepth")
"""Subtopics of an image."""
_OF_WORLD = re.compile(
    r"/stats|/world/[^/]+/(?:stats|state|(?:dynamic_)?pose/info|scene/(?:info|deletion))"
)
"""Topics that gz-sim publishes itself about each world."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Bridged:
    """One entry: a Gazebo topic, and its name and type in ROS."""

    gz: str
    ros: str
    type: str
    """Message type in ROS, ``pkg/msg/Name``."""
    origin: Origin


class TopicRenaming:
    """The topics of a graph that a bridge renames in ROS.

    Plugins look up the names of their topics here, so that the graph has the same topics as ROS has
    behind the bridge.
    """

    def __init__(self) -> None:
        self._entries: dict[str, Bridged] = {}
        self._asked: dict[str, str] = {}
        """Types that plugins have requested, by Gazebo topic."""
        self._faults: list[Diagnostic] = []

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
                hint = suggestion(entry.gz, sorted(self._asked))
                if _OF_WORLD.fullmatch(entry.gz):
                    message = f'Cartwheel does not publish the topic "{entry.gz}" of gz-sim, so '
                    message, hint = f"{message}{entry.ros} has no effect", ""
                yield _warning(entry, message, hint)
            elif own is not None and own != entry.type and _inside(entry.type, own) is None:
                yield _warning(entry, f"{entry.ros} must have the type {own} (got {entry.type})")

    def _entry(self, name: str, type_name: str) -> Bridged | None:
        self._asked[name] = type_name
        return self._entries.get(name)


def _warning(entry: Bridged, message: str, hint: str = "") -> Diagnostic:
    return devices.BRIDGE_ENTRY_IGNORED.diagnostic(
        message, origin=entry.origin, hint=hint, values={"gz": entry.gz, "ros": entry.ros}
    )


def _inside(outer: str, inner: str) -> str | None:
    """Returns the field of a stamped message that contains the inner message."""
    if outer != f"{inner}Stamped":
        return None
    return next((field.name for field in fields(outer) if field.type == inner), None)
