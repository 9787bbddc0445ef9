"""Moments and spans as messages tell them."""

from __future__ import annotations

from typing import Any

_SECOND = 1_000_000_000


def nanoseconds(value: Any) -> int:
    """Of a ``builtin_interfaces/Time`` or ``Duration``."""
    return int(value.sec) * _SECOND + int(value.nanosec)
