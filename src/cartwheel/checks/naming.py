"""Names of several elements in messages."""

from __future__ import annotations

from collections.abc import Sequence

_SHOWN = 4
"""Maximum number of names in a message."""


def joints_named(names: Sequence[str]) -> str:
    """Joints as a noun phrase, such as ``joints "a", "b", "c", "d" and 2 more``."""
    shown = ", ".join(f'"{name}"' for name in names[:_SHOWN])
    more = f" and {len(names) - _SHOWN} more" if len(names) > _SHOWN else ""
    return f"joint{'s' * (len(names) > 1)} {shown}{more}"
