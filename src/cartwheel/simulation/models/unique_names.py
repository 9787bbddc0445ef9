"""Unique model names."""

from __future__ import annotations

import itertools
from collections.abc import Collection


def free_name(name: str, taken: Collection[str]) -> str:
    """`name`, with the lowest number appended that makes it unique if it is in use."""
    if name not in taken:
        return name
    return next(numbered for i in itertools.count(1) if (numbered := f"{name}_{i}") not in taken)
