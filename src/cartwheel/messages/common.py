"""Fields that most messages share."""

from __future__ import annotations

import functools
from typing import Any

from cartwheel.messages.store import message_class

_SECOND = 1_000_000_000


@functools.cache
def _time_class() -> Any:
    return message_class("builtin_interfaces/msg/Time")


@functools.cache
def _header_class() -> Any:
    return message_class("std_msgs/msg/Header")


_recent: tuple[tuple[int, Any], tuple[int, Any]] = ((-1, None), (-1, None))
"""The last two timestamps in ns, with their messages: wheel transforms have a timestamp 1 ns after
all other messages.

The tuple is always replaced as a whole, because simulations in several threads may share it.
"""
_NONE = (None, None, None, None)
newest_headers: dict[str, tuple[int, Any, int | None, Any]] = {}
"""The last two headers of each frame, the newest first, each after its time in ns. Only `header`
changes it."""
_MOST_FRAMES = 1000


def stamp(time_ns: int) -> Any:
    """``builtin_interfaces/Time`` of a simulation time. Messages with the same time share it."""
    global _recent
    newest, older = _recent
    if newest[0] == time_ns:
        return newest[1]
    if older[0] == time_ns:
        return older[1]
    made = _time_class()(time_ns // _SECOND, time_ns % _SECOND)
    _recent = ((time_ns, made), newest)
    return made


def header(time_ns: int, frame: str) -> Any:
    """``std_msgs/Header``, shared by messages with the same time and frame. It must not change."""
    newest, made, older, before = newest_headers.get(frame, _NONE)
    if newest == time_ns:
        return made
    if older == time_ns:
        return before
    if len(newest_headers) > _MOST_FRAMES:
        newest_headers.clear()
    made, before = _header_class()(stamp(time_ns), frame), made
    newest_headers[frame] = (time_ns, made, newest, before)
    return made
