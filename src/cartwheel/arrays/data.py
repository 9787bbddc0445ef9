"""The data of messages as numpy arrays, and the error for data that do not fit."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from cartwheel.codes.graph import ARRAY_INVALID
from cartwheel.errors import GraphError

Array: TypeAlias = NDArray[Any]


def kind_of(message: Any) -> str:
    """The name of a message's type without its package."""
    return full_kind_of(message).rpartition("/")[2]


def full_kind_of(message: Any) -> str:
    """The name of a message's type."""
    return str(getattr(type(message), "__msgtype__", type(message).__name__))


def require(message: Any, kind: str, *fields: str) -> None:
    """Checks that a message has the fields of a type.

    Raises:
        GraphError: It does not, or there is no message.
    """
    if message is None:
        raise GraphError(
            f"there is no message, and a {kind} is expected",
            code=ARRAY_INVALID,
            values={"expected": kind},
            hint="Subscribe to the topic, and run the world until the first message is published.",
        )
    if not all(hasattr(message, field) for field in fields):
        found = full_kind_of(message)
        raise invalid(f"a {kind} is expected, and the message is a {found}", expected=kind)


def bytes_of(message: Any) -> Array:
    """The data of a message, as bytes."""
    data = message.data
    if isinstance(data, bytes | bytearray | memoryview):
        return np.frombuffer(data, np.uint8)
    try:
        found = np.asarray(data)
    except (ValueError, OverflowError):
        found = np.zeros((0, 0))
    if found.ndim != 1 or (found.size and found.dtype != np.uint8):
        raise invalid("the data of the message are not bytes")
    return np.ascontiguousarray(found, dtype=np.uint8)


def vector(message: Any, field: str) -> Array:
    """A field with a sequence of numbers, shape (N,)."""
    numbers = np.asarray(getattr(message, field))
    if numbers.ndim != 1:
        raise invalid(f"the field {field} is not a sequence of numbers", field=field)
    return locked(numbers[:])


def locked(numbers: Array) -> Array:
    """Makes an array read-only, and returns it."""
    numbers.flags.writeable = False
    return numbers


def invalid(message: str, **values: Any) -> GraphError:
    """The error for data that do not fit."""
    return GraphError(message, code=ARRAY_INVALID, values=values)
