"""Parts that most messages share."""

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
"""What all messages of one time share: the time in ns, its stamp, its headers by frame."""
_recent: tuple[_Moment, _Moment] = ((-1, None, {}), (-1, None, {}))
"""The last two: wheels' transforms are stamped a nanosecond after all else of their time.

One name, always set as a whole: simulations in several threads may take turns with it.
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
    """``builtin_interfaces/Time`` of a simulation time; messages of one time share it."""
    return _moment(time_ns)[1]


def header(time_ns: int, frame: str) -> Any:
    """``std_msgs/Header``; messages of one time and frame share it, as none may be changed."""
    _, shared, headers = _moment(time_ns)
    made = headers.get(frame)
    if made is None:
        made = headers[frame] = _header_class()(shared, frame)
    return made
