"""Names for models where others stand already."""

from __future__ import annotations

import itertools
from collections.abc import Collection


def free_name(name: str, taken: Collection[str]) -> str:
    """`name`, or with the first number that makes it a new one."""
    if name not in taken:
        return name
    return next(numbered for i in itertools.count(1) if (numbered := f"{name}_{i}") not in taken)
