"""Decoding of ROS 1 bytes, which may be malformed or malicious."""

from __future__ import annotations

import functools
import struct
from collections.abc import Callable
from typing import Any

import numpy as np

from cartwheel.codes.graph import MESSAGE_NOT_DECODABLE
from cartwheel.errors import GraphError
from cartwheel.messages.classes import FILLER
from cartwheel.messages.convert import zero
from cartwheel.messages.field import CODES, Field
from cartwheel.messages.ros1.fields import Pair, pairs
from cartwheel.messages.store import loaded, message_class, type_name

_COUNT = struct.Struct("<I")
_EMPTIES = 1 << 16
"""Additional list elements that a message may contain, for elements without any bytes."""
_NESTED = 8
"""List elements that a message may contain per byte, which allows eight nested lists."""

_Reader = Callable[["_Source"], Any]


class _Source:
    """Bytes and a read position."""

    __slots__ = ("data", "elements", "offset")

    def __init__(self, data: bytes | memoryview, elements: int | None) -> None:
        self.data = memoryview(data)
        self.offset = 0
        most = _NESTED * len(self.data) + _EMPTIES
        self.elements = most if elements is None else min(elements, most)
        """Remaining number of list elements."""

    def take(self, size: int) -> memoryview:
        end = self.offset + size
        if end > len(self.data):
            raise ValueError(
                f"{size} bytes are expected, but only {len(self.data) - self.offset} remain"
            )
        taken = self.data[self.offset : end]
        self.offset = end
        return taken

    def count(self) -> int:
        (count,) = _COUNT.unpack(self.take(4))
        return int(count)


def decode_ros1(data: bytes | memoryview, type_name: str, *, elements: int | None = None) -> Any:
    """Decodes ROS 1 bytes into the graph's message. Its arrays are views of the bytes.

    Args:
        data: Encoded message.
        type_name: Type name in the graph.
        elements: Maximum number of elements in all lists of messages and strings, which are slow
            to decode. Arrays of numbers do not count. None derives the limit from the number of
            bytes.

    Raises:
        UnknownNameError: The type does not exist.
        GraphError: The bytes are not a message of that type.
    """
    read = _reader(message_class(type_name).__msgtype__)
    source = _Source(data, elements)
    try:
        message = read(source)
    except (ValueError, struct.error) as error:
        raise GraphError(
            f"{len(data)} bytes cannot be decoded as {type_name}: {error}",
            code=MESSAGE_NOT_DECODABLE,
            values={"type": type_name, "bytes": len(data)},
        ) from error
    if source.offset != len(source.data):
        left = len(source.data) - source.offset
        raise GraphError(
            f"{len(data)} bytes cannot be decoded as {type_name}: {left} bytes remain after the "
            "message",
            code=MESSAGE_NOT_DECODABLE,
            values={"type": type_name, "bytes": len(data)},
        )
    return message


@functools.cache
def _reader(name: str) -> _Reader:
    full = type_name(name)
    made = message_class(full)
    readers = [(pair.name, _field_reader(pair)) for pair in pairs(full)]
    read_names = {ours for ours, _ in readers}
    rest = {
        field: getattr(zero(full), field)
        for field, _ in loaded().fielddefs[full][1]
        if field not in read_names and field != FILLER
    }
    if any(field == FILLER for field, _ in loaded().fielddefs[full][1]):
        rest[FILLER] = 0

    def read(source: _Source) -> Any:
        values = dict(rest)
        for ours, read_field in readers:
            value = read_field(source)
            if ours is not None:
                values[ours] = value
        return made(**values)

    return read


def _field_reader(pair: Pair) -> _Reader:
    field = pair.field
    if pair.form == "list":
        return _list_reader(field, _single_reader(field))
    return _array_reader(field) if field.array else _single_reader(field)


def _single_reader(field: Field) -> _Reader:
    if field.kind == "message":
        return _reader(field.type)
    if field.kind == "string":
        return _read_text
    unpack = struct.Struct(f"<{CODES[field.type]}")
    return lambda source: unpack.unpack(source.take(unpack.size))[0]


def _read_text(source: _Source) -> str:
    return bytes(source.take(source.count())).decode(errors="replace")


def _list_reader(field: Field, read: _Reader) -> _Reader:
    def read_list(source: _Source) -> list[Any]:
        count = source.count() if field.length is None else field.length
        if count > source.elements:
            raise ValueError(
                f"a list has {count} elements, but at most {source.elements} are allowed"
            )
        source.elements -= count
        return [read(source) for _ in range(count)]

    return read_list


def _array_reader(field: Field) -> _Reader:
    dtype = np.dtype(field.type).newbyteorder("<")

    def read_array(source: _Source) -> Any:
        count = source.count() if field.length is None else field.length
        return np.frombuffer(source.take(count * dtype.itemsize), dtype=dtype)

    return read_array
