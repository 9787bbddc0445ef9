"""Definitions and hashes of message types in ROS 2."""

from __future__ import annotations

import functools

from cartwheel.messages.definition import short_name
from cartwheel.messages.learnt import learnt, text_with_nested
from cartwheel.messages.ros2.types import is_ros1_only, ros2_type
from cartwheel.messages.store import TWIN, loaded, message_class


@functools.cache
def ros2_definition(name: str) -> str:
    """Definition of a message type with all nested types, as in recordings.

    Raises:
        UnknownNameError: The type does not exist.
    """
    full = message_class(name).__msgtype__
    if learnt(full) is not None:
        return text_with_nested(full, 2, loaded(), short_name)
    text, _ = loaded().generate_msgdef(full, ros_version=2)
    return str(text).replace(f"{TWIN}/", "/")


@functools.cache
def ros2_hash(name: str) -> str:
    """ROS 2 hash of a type, ``RIHS01_…``; empty if it has none. Source: REP 2011.

    Raises:
        UnknownNameError: The type does not exist.
    """
    full = message_class(name).__msgtype__
    return "" if is_ros1_only(full) else ros2_type(full).hash
