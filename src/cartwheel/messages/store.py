"""ROS 2 message classes, rosbags' own and those made from our definitions."""

from __future__ import annotations

import functools
from pathlib import Path
from typing import Any

from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from cartwheel.errors import UnknownNameError

_DEFINITIONS = Path(__file__).parent / "definitions"


@functools.cache
def store() -> Any:
    """The typestore: Jazzy's types and ``definitions/<package>/<msg|srv>/``'s."""
    made = get_typestore(Stores.ROS2_JAZZY)
    for path in sorted(_DEFINITIONS.glob("*/msg/*.msg")):
        name = f"{path.parent.parent.name}/msg/{path.stem}"
        if name not in made.fielddefs:
            made.register(get_types_from_msg(path.read_text(), name))
    for path in sorted(_DEFINITIONS.glob("*/srv/*.srv")):
        package = path.parent.parent.name
        request, _, response = path.read_text().partition("---\n")
        for part, text in (("Request", request), ("Response", response)):
            name = f"{package}/srv/{path.stem}_{part}"
            if name not in made.fielddefs:
                made.register(get_types_from_msg(text, name))
    return made


def type_name(name: str) -> str:
    """The ROS 2 name of a message type: ``geometry_msgs/Twist`` is ``geometry_msgs/msg/Twist``."""
    package, _, rest = name.partition("/")
    return name if "/" in rest else f"{package}/msg/{rest}"


def message_class(name: str) -> Any:
    """The class of a message type; a dataclass with one field for each of the message's.

    Raises:
        UnknownNameError: There is no such type.
    """
    full = type_name(name)
    types = store().types
    if full not in types:
        raise UnknownNameError("message type", name, types)
    return types[full]
