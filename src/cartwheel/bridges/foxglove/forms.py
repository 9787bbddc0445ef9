"""Encoding of message types for clients."""

from __future__ import annotations

import functools
from typing import Any, Literal

from cartwheel.bridges.bridged import BridgedGraph
from cartwheel.messages.ros1 import encode_ros1, ros1_type
from cartwheel.messages.ros2.definitions import ros2_definition
from cartwheel.messages.ros2.types import ros2_name

Encoding = Literal["cdr", "ros1"]


@functools.cache
def encoding_of(*types: str) -> Encoding:
    """ROS 2 encoding, except for types with fields that only ROS 1 allows.

    Clients reject ROS 2 definitions of such types.

    Args:
        types: Types that need the same encoding, such as a request and its response.
    """
    # For example hiStop and Kp: ROS 2 field names have no capitals.
    names = [name for kind in types for name in _fields(kind)]
    return "cdr" if all(name == name.lower() for name in names) else "ros1"


def schema_of(kind: str, encoding: Encoding) -> Any:
    """Name and definition of a type for the server.

    Raises:
        UnknownNameError: The type does not exist.
    """
    import foxglove

    if encoding == "ros1":
        found = ros1_type(kind)
        text = found.definition.encode()
        return foxglove.Schema(name=found.name, encoding="ros1msg", data=text)
    text = ros2_definition(kind).encode()
    return foxglove.Schema(name=ros2_name(kind), encoding="ros2msg", data=text)


def packed(graph: BridgedGraph, message: Any, encoding: Encoding) -> bytes:
    """Bytes of a message. Messages that other wires also send are serialised once."""
    return graph.cdr.encode(message) if encoding == "cdr" else encode_ros1(message)


def _fields(kind: str) -> list[str]:
    """Names of the fields of a type and of its nested types."""
    names = []
    for line in ros2_definition(kind).splitlines():
        words = line.split()
        if len(words) == 2 and words[0] != "MSG:" and "=" not in line:
            names.append(words[1])
    return names
