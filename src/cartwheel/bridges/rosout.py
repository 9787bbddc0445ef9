"""Diagnostics as ROS 2 messages of ``/rosout``."""

from __future__ import annotations

from typing import Any

from cartwheel.errors import Diagnostic
from cartwheel.messages import encode_cdr, message_class, stamp

TOPIC, TYPE = "/rosout", "rcl_interfaces/msg/Log"
_LEVELS = {"info": 20, "warning": 30, "error": 40}


def line(diagnostic: Diagnostic, *, node: str, time_ns: int) -> bytes:
    """A diagnostic as an encoded message."""
    origin = diagnostic.origin
    message: Any = message_class(TYPE)(
        stamp=stamp(time_ns),
        level=_LEVELS[diagnostic.severity],
        name=node,
        msg=diagnostic.text,
        file=origin.file if origin else "",
        line=origin.line if origin else 0,
    )
    return encode_cdr(message)
