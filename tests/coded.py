"""Diagnostics by their codes and values, which stay when their words change."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from cartwheel.errors import Code, Diagnostic


def coded(source: Any, code: Code, **values: object) -> list[Diagnostic]:
    """The diagnostics of a code that have these values.

    Args:
        source: A world, a session, or diagnostics.
        code: Their code.
        values: Those that must be among theirs.
    """
    diagnostics: Iterable[Diagnostic] = getattr(source, "diagnostics", source)
    return [
        each
        for each in diagnostics
        if each.code is code and all(each.values.get(key) == one for key, one in values.items())
    ]
