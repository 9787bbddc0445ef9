"""Places of numbers in the bytes of a message."""

from __future__ import annotations

import struct
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Place:
    """A number, or an array of numbers, in the bytes of a message."""

    path: str
    """Names and indices, joined with dots: ``transforms.0.header.stamp.sec``."""
    at: int
    """Offset in bytes."""
    code: str
    """`struct` code of the number, or of one element of the array."""
    count: int | None = None
    """Number of elements of an array."""

    @property
    def size(self) -> int:
        """Size in bytes."""
        return struct.calcsize(f"<{self.code}") * (1 if self.count is None else self.count)
