"""Messages as the bytes of a recording, with the definitions that go with them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from cartwheel.bridges.recording.formats import Encoding
from cartwheel.messages import encode_cdr, type_name
from cartwheel.messages.ros1 import encode_ros1, ros1_type
from cartwheel.messages.ros2 import ros2_definition, ros2_hash
from cartwheel.messages.ros2_types import ros2_name

Pack = Callable[[Any], bytes]


@dataclass(frozen=True, kw_only=True, slots=True)
class Schema:
    """A message type as a recording states it."""

    name: str
    """``pkg/msg/Name``, in ROS 1 ``pkg/Name``."""
    text: str
    """With the definitions of all types within it."""
    hash: str
    """ROS 1's md5 sum, ROS 2's RIHS01."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Codec:
    """How the messages of an encoding are written."""

    messages: str
    """MCAP's name of it."""
    schemas: str
    """MCAP's name of its definitions."""
    encode: Callable[[Any, int], bytes]
    """Of a message and its number on the topic."""
    schema: Callable[[str], Schema]


def codec(encoding: Encoding, pack: Pack = encode_cdr) -> Codec:
    """The codec of an encoding.

    Args:
        encoding: Which one.
        pack: Makes ROS 2's bytes.
    """
    if encoding == "ros1":
        return _ROS1
    return Codec(
        messages="cdr",
        schemas="ros2msg",
        encode=lambda message, _: pack(message),
        schema=_ros2_schema,
    )


def _ros1_schema(name: str) -> Schema:
    known = ros1_type(name)
    return Schema(name=known.name, text=known.definition, hash=known.md5)


def _ros2_schema(name: str) -> Schema:
    full = type_name(name)
    return Schema(name=ros2_name(full), text=ros2_definition(full), hash=ros2_hash(full))


_ROS1 = Codec(
    messages="ros1",
    schemas="ros1msg",
    encode=lambda message, seq: encode_ros1(message, seq=seq),
    schema=_ros1_schema,
)
