"""Definitions and hashes of message types in ROS 2."""

from __future__ import annotations

import functools

from cartwheel.messages.definition import short_name
from cartwheel.messages.learnt import learnt
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
        return _learnt_text(full)
    text, _ = loaded().generate_msgdef(full, ros_version=2)
    return str(text).replace(f"{TWIN}/", "/")


def _learnt_text(full: str) -> str:
    """The definition of a type from a package, with all nested types."""
    texts: dict[str, str] = {}
    waiting = [full]
    while waiting:
        name = waiting.pop()
        if name in texts:
            continue
        known = learnt(name)
        if known is not None:
            texts[name] = known.written(2)
            waiting += [used.type for used in reversed(known.uses)]
        else:
            nested: dict[str, tuple[str, str]] = {}
            message_class(name)
            texts[name], _ = loaded().gendefhash(name, nested, 2)
            texts.update({each: text for each, (text, _) in nested.items() if each not in texts})
    line = "=" * 80
    return texts.pop(full) + "".join(
        f"{line}\nMSG: {short_name(name)}\n{text}" for name, text in texts.items()
    )


@functools.cache
def ros2_hash(name: str) -> str:
    """ROS 2 hash of a type, ``RIHS01_…``; empty if it has none. Source: REP 2011.

    Raises:
        UnknownNameError: The type does not exist.
    """
    full = message_class(name).__msgtype__
    return "" if is_ros1_only(full) else ros2_type(full).hash
