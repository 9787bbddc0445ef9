"""Decoding of CDR for types with ``wstring`` fields, which rosbags does not support.

Source: DDS-XTypes, plain CDR of version 1; rosidl_typesupport_fastrtps for ``wstring``.
"""

from __future__ import annotations

import functools
import struct
from typing import Any, Literal

import numpy as np

from cartwheel.messages.classes import FILLER
from cartwheel.messages.field import CODES, Field, field_of
from cartwheel.messages.learnt import learnt
from cartwheel.messages.store import loaded, message_class

_HEAD = 4
"""Size of the encapsulation header in bytes. Offsets are counted from its end."""
_EMPTIES = 1 << 16
"""Additional list elements that a message may contain, for elements without any bytes."""


@functools.cache
def has_wide_text(name: str) -> bool:
    """Whether a type contains a ``wstring``."""
    known = learnt(name)
    if known is None:
        return False
    return known.has_wide_text or any(has_wide_text(used.type) for used in known.uses)


def read_cdr(data: bytes | memoryview, name: str, *, padded: bool = False) -> Any:
    """Decodes a message; see `decode_cdr`.

    Raises:
        ValueError: The bytes are not a message of this type.
    """
    source = _Source(data)
    message = source.message(name)
    left = bytes(source.data[source.at :])
    # A writer may pad the message to a multiple of four bytes.
    if any(left) or (len(left) > 3 and not padded):
        raise ValueError(f"{len(left)} bytes remain after the message")
    return message


@functools.cache
def _fields(name: str) -> tuple[Field, ...]:
    full = message_class(name).__msgtype__
    return tuple(field_of(*each) for each in loaded().fielddefs[full][1])


class _Source:
    """Bytes and a read position."""

    def __init__(self, data: bytes | memoryview) -> None:
        if len(data) < _HEAD or data[0] or data[1] not in (0, 1):
            raise ValueError("the encapsulation header is invalid")
        self._order: Literal["<", ">"] = "<" if data[1] else ">"
        self.data = memoryview(data)[_HEAD:]
        self.at = 0
        self._elements = len(data) + _EMPTIES

    def message(self, name: str) -> Any:
        values = {field.name: self._value(field) for field in _fields(name)}
        return message_class(name)(**values)

    def _take(self, size: int, aligned: int = 1) -> memoryview:
        self.at += -self.at % aligned
        end = self.at + size
        if end > len(self.data):
            raise ValueError(f"{size} bytes are expected at {self.at}, but fewer remain")
        taken = self.data[self.at : end]
        self.at = end
        return taken

    def _number(self, code: str) -> Any:
        size = struct.calcsize(f"<{code}")
        (value,) = struct.unpack(f"{self._order}{code}", self._take(size, size))
        return value

    def _value(self, field: Field) -> Any:
        if field.name == FILLER:
            return self._number("B")
        if not field.array:
            return self._one(field)
        count = self._number("I") if field.length is None else field.length
        if field.kind in ("message", "string"):
            if count > self._elements:
                raise ValueError(
                    f"a list has {count} elements, but the message is too short for them"
                )
            self._elements -= count
            return [self._one(field) for _ in range(count)]
        if not count:
            return np.zeros(0, dtype=field.type)
        dtype = np.dtype(field.type).newbyteorder(self._order)
        return np.frombuffer(self._take(count * dtype.itemsize, dtype.itemsize), dtype=dtype)

    def _one(self, field: Field) -> Any:
        if field.kind == "message":
            return self.message(field.type)
        if field.kind != "string":
            return self._number(CODES[field.type])
        count = self._number("I")
        if field.wide:
            # Each UTF-16 code unit has four bytes.
            units = np.frombuffer(self._take(4 * count), dtype=f"{self._order}u4")
            if units.size and units.max() > 0xFFFF:
                raise ValueError("a character of a wide string has more than 16 bits")
            return units.astype("<u2").tobytes().decode("utf-16-le", "replace")
        return bytes(self._take(count)).rstrip(b"\0").decode(errors="replace")
