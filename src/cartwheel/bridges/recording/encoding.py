"""Encoding of recorded messages, with their definitions."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from cartwheel.bridges.recording.formats import Encoding
from cartwheel.messages import encode_cdr, type_name
from cartwheel.messages.ros1 import encode_ros1, ros1_type
from cartwheel.messages.ros2.definitions import ros2_definition, ros2_hash
from cartwheel.messages.ros2.types import ros2_name

Pack = Callable[[Any], bytes]


@dataclass(frozen=True, kw_only=True, slots=True)
class Schema:
    """A message type in a recording."""

    name: str
    """``pkg/msg/Name``; in ROS 1 ``pkg/Name``."""
    text: str
    """Definition, including all nested types."""
    hash: str
    """md5 sum in ROS 1, RIHS01 in ROS 2."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Codec:
    """Encoder for messages of one encoding."""

    messages: str
    """MCAP's name of the message encoding."""
    schemas: str
    """MCAP's name of the schema encoding."""
    encode: Callable[[Any, int], bytes]
    """Encodes a message, with its sequence number on the topic."""
    schema: Callable[[str], Schema]


def codec(encoding: Encoding, pack: Pack = encode_cdr) -> Codec:
    """Codec of an encoding.

    Args:
        encoding: Encoding of the messages.
        pack: Serialises a message for ROS 2.
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
