"""Times and durations in messages."""

from __future__ import annotations

from typing import Any

_SECOND = 1_000_000_000


def nanoseconds(value: Any) -> int:
    """Converts a ``builtin_interfaces/Time`` or ``Duration`` to ns."""
    return int(value.sec) * _SECOND + int(value.nanosec)
