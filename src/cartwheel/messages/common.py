"""Parts that most messages share."""

from __future__ import annotations

import functools
from typing import Any

from cartwheel.messages.store import message_class

_SECOND = 1_000_000_000


class _Moment:
    """What all messages of one time have in common."""

    __slots__ = ("headers", "stamp", "time_ns")

    def __init__(self, time_ns: int) -> None:
        self.time_ns = time_ns
        self.stamp = _time_class()(time_ns // _SECOND, time_ns % _SECOND)
        self.headers: dict[str, Any] = {}


@functools.cache
def _time_class() -> Any:
    return message_class("builtin_interfaces/msg/Time")


@functools.cache
def _header_class() -> Any:
    return message_class("std_msgs/msg/Header")


_last: _Moment | None = None
"""One name, always set as a whole: simulations in several threads may take turns with it."""


def _moment(time_ns: int) -> _Moment:
    global _last
    moment = _last
    if moment is None or moment.time_ns != time_ns:
        moment = _last = _Moment(time_ns)
    return moment


def stamp(time_ns: int) -> Any:
    """``builtin_interfaces/Time`` of a simulation time; messages of one time share it."""
    return _moment(time_ns).stamp


def header(time_ns: int, frame: str) -> Any:
    """``std_msgs/Header``; messages of one time and frame share it, as none may be changed."""
    moment = _moment(time_ns)
    made = moment.headers.get(frame)
    if made is None:
        made = moment.headers[frame] = _header_class()(moment.stamp, frame)
    return made
