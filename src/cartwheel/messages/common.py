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


_Moment = tuple[int, Any, dict[str, Any]]
"""What messages with the same timestamp share: time in ns, stamp, and headers by frame."""
_recent: tuple[_Moment, _Moment] = ((-1, None, {}), (-1, None, {}))
"""The last two timestamps: wheel transforms have a timestamp 1 ns after all other messages.

The tuple is always replaced as a whole, because simulations in several threads may share it.
"""


def _moment(time_ns: int) -> _Moment:
    global _recent
    newest, older = _recent
    if newest[0] == time_ns:
        return newest
    if older[0] == time_ns:
        return older
    moment: _Moment = (time_ns, _time_class()(time_ns // _SECOND, time_ns % _SECOND), {})
    _recent = (moment, newest)
    return moment


def stamp(time_ns: int) -> Any:
    """``builtin_interfaces/Time`` of a simulation time. Messages with the same time share it."""
    return _moment(time_ns)[1]


def header(time_ns: int, frame: str) -> Any:
    """``std_msgs/Header``, shared by messages with the same time and frame. It must not change."""
    _, shared, headers = _moment(time_ns)
    made = headers.get(frame)
    if made is None:
        made = headers[frame] = _header_class()(shared, frame)
    return made
