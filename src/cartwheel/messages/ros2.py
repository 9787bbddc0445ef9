"""What ROS 2 calls the message types, beyond their names."""

from __future__ import annotations

import functools

from cartwheel.messages.ros2_types import is_ros1_only, ros2_type
from cartwheel.messages.store import TWIN, loaded, message_class


@functools.cache
def ros2_definition(name: str) -> str:
    """The text of a message type with those of all types within it, as recordings carry it.

    Raises:
        UnknownNameError: There is no such type.
    """
    text, _ = loaded().generate_msgdef(message_class(name).__msgtype__, ros_version=2)
    return str(text).replace(f"{TWIN}/", "/")


@functools.cache
def ros2_hash(name: str) -> str:
    """ROS 2's hash of a type, ``RIHS01_…``; empty where it has none. Source: REP 2011.

    Raises:
        UnknownNameError: There is no such type.
    """
    full = message_class(name).__msgtype__
    return "" if is_ros1_only(full) else ros2_type(full).hash
