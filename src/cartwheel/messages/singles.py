"""Numbers of ``float32`` fields, which are rounded when a message is created.

A message then has the same values as after it was sent or recorded.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Callable, Sequence
from operator import attrgetter
from typing import Any

import numpy as np

_FLOATS = frozenset({float, np.float64})
_SINGLE = struct.Struct("<f")


def single(value: float) -> float:
    """The ``float32`` that is nearest to a number.

    Raises:
        OverflowError: The number is finite, and too large for a ``float32``.
    """
    rounded: float = _SINGLE.unpack(_SINGLE.pack(value))[0]
    return rounded


def is_single(value: float) -> bool:
    """Whether a number has a value that a ``float32`` can have."""
    try:
        return single(value) == value or math.isnan(value)
    except OverflowError:
        return False


def rounding(names: Sequence[str]) -> Callable[[Any], None]:
    """A function that rounds fields of a message.

    It leaves a message as it is if one of them is not a number, or too large: `checked` refuses or
    converts it.
    """
    read = attrgetter(*names, names[0])
    layout = struct.Struct(f"<{len(names)}f")

    def round_fields(message: Any) -> None:
        *values, _ = read(message)
        for value in values:
            if type(value) not in _FLOATS:
                return
        try:
            rounded = layout.unpack(layout.pack(*values))
        except OverflowError:
            return
        for name, value in zip(names, rounded, strict=True):
            setattr(message, name, value)

    return round_fields
