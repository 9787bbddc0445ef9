"""Configuration files of ros_gz_bridge: names and types of gz-sim's topics in ROS."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from cartwheel import yaml_text
from cartwheel.codes import devices
from cartwheel.errors import CartwheelError, GraphError, Origin
from cartwheel.graph import resolve_name
from cartwheel.graph.renaming import Bridged
from cartwheel.messages import type_name

_AXIS = re.compile(r"(/joint/[^/]+)/\d+(?=/)")
"""The axis in a topic of a joint, such as ``/model/arm/joint/elbow/0/cmd_pos``."""


def gz_topic(name: str) -> str:
    """Converts a gz-sim topic name, which can contain dashes and leading digits, to ROS.

    The axis of a joint is left out.
    """
    name = _AXIS.sub(r"\1", name)
    parts = [re.sub(r"\W", "_", part, flags=re.ASCII) for part in name.strip("/").split("/")]
    return "".join(f"/_{part}" if part[:1].isdigit() else f"/{part}" for part in parts)


def gz_spelling(topic: str) -> str:
    """Converts a topic in a description as `gz_topic` does, but a relative one stays relative."""
    topic = topic.strip()
    spelt = gz_topic(topic) if topic else ""
    return spelt if topic.startswith("/") else spelt.removeprefix("/")


def namespaced(topic: str, namespace: str) -> str:
    """Returns the global name of a topic in a description, which may be relative."""
    return resolve_name(gz_spelling(topic), namespace)


Bridge = Path | Bridged
"""A configuration file, or one of its entries."""


def entries_of(bridge: Bridge) -> list[Bridged]:
    """Returns the entries of a file, see `read_bridge`, or a single one."""
    return [bridge] if isinstance(bridge, Bridged) else read_bridge(bridge)


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
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        text, line = yaml_text.fault(error)
        raise _invalid(text, Origin(file=str(path), line=line)) from None
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
