"""What ROS 2 calls the message types, beyond their names."""

from __future__ import annotations

import functools

from cartwheel.messages.store import message_class, store


@functools.cache
def ros2_definition(name: str) -> str:
    """The text of a message type with those of all types within it, as recordings carry it.

    Raises:
        UnknownNameError: There is no such type.
    """
    text, _ = store().generate_msgdef(message_class(name).__msgtype__, ros_version=2)
    return str(text)


@functools.cache
def ros2_hash(name: str) -> str:
    """ROS 2's hash of a type, ``RIHS01_…``; empty where it cannot be told.

    Source: REP 2011. A type that holds ``char`` gets none: its hash would be another's.

    Raises:
        UnknownNameError: There is no such type.
    """
    full = message_class(name).__msgtype__
    if "char " in ros2_definition(full) or "char[" in ros2_definition(full):
        return ""
    return str(store().hash_rihs01(full))
