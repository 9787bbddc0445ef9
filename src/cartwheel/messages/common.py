"""Parts that most messages share."""

from __future__ import annotations

from typing import Any

from cartwheel.messages.store import message_class

_SECOND = 1_000_000_000


def stamp(time_ns: int) -> Any:
    """``builtin_interfaces/Time`` of a simulation time."""
    return message_class("builtin_interfaces/msg/Time")(
        sec=time_ns // _SECOND, nanosec=time_ns % _SECOND
    )


def header(time_ns: int, frame: str) -> Any:
    """``std_msgs/Header``."""
    return message_class("std_msgs/msg/Header")(stamp=stamp(time_ns), frame_id=frame)
