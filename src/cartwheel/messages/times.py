"""Times and durations in messages."""

from __future__ import annotations

from typing import Any, Protocol, TypeGuard

_SECOND = 1_000_000_000


class Stamp(Protocol):
    """A ``builtin_interfaces/Time`` or ``Duration``, such as the stamp of a header."""

    @property
    def sec(self) -> int:
        """Whole seconds."""

    @property
    def nanosec(self) -> int:
        """Nanoseconds after them."""


def nanoseconds(value: Any) -> int:
    """Converts a ``builtin_interfaces/Time`` or ``Duration`` to ns."""
    return int(value.sec) * _SECOND + int(value.nanosec)


def seconds(stamp: Stamp) -> float:
    """Converts a time or duration of a message to s, such as ``message.header.stamp``."""
    return nanoseconds(stamp) / _SECOND


def is_stamp(value: object) -> TypeGuard[Stamp]:
    """Whether a value is a time or duration of a message."""
    return hasattr(value, "sec") and hasattr(value, "nanosec")
