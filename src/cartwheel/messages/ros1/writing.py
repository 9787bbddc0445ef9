"""Messages as ROS 1 bytes. Each type is compiled once into a plan that packs it in few calls."""

from __future__ import annotations

import functools
import struct
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from operator import attrgetter
from typing import Any

import numpy as np

from cartwheel.codes.graph import MESSAGE_NOT_ENCODABLE
from cartwheel.errors import GraphError
from cartwheel.messages.field import CODES, Field
from cartwheel.messages.ros1.fields import HEADER, pairs

_COUNT = struct.Struct("<I")
_SHARED = 4096
"""Minimum size in bytes of an array that is passed on without a copy."""

Parts = list[Any]
"""Bytes and views of arrays, to be joined."""
_Writer = Callable[[Any, Parts], None]


def write_ros1(message: Any, *, seq: int = 0) -> Parts:
    """Encodes a message in parts, so that large arrays are copied only once, when joined.

    Args:
        message: Message of the graph.
        seq: Sequence number of the header, if the message begins with a header.

    Raises:
        UnknownNameError: ROS 1 does not have this type.
        GraphError: A value does not fit its field.
    """
    parts: Parts = []
    try:
        _plan(message.__msgtype__)(message, parts, seq)
    except (struct.error, TypeError, AttributeError, ValueError) as error:
        raise GraphError(
            f"ROS 1 cannot represent this {message.__msgtype__}: {error}",
            code=MESSAGE_NOT_ENCODABLE,
            values={"type": message.__msgtype__},
        ) from error
    return parts


def encode_ros1(message: Any, *, seq: int = 0) -> bytes:
    """Encodes a message; see `write_ros1`."""
    return b"".join(write_ros1(message, seq=seq))


@dataclass(frozen=True, slots=True)
class _Fixed:
    """A part of fixed size: a number's `struct` code, or a number of zero bytes."""

    code: str
    path: str | None


@dataclass(frozen=True, slots=True)
class _Counted:
    """A part whose size depends on its value."""

    field: Field
    path: str


class _Plan:
    """Writes messages of one type."""

    def __init__(self, name: str) -> None:
        self._seq = False
        found = list(_flat(name, ""))
        pending: list[_Fixed] = []
        writers: list[_Writer] = []
        header = pairs(name)[:1]
        if header and header[0].field.type == HEADER and not header[0].field.array:
            # The first field is seq, which the graph's messages do not have.
            self._seq = True
            found = found[1:]
        for step in found:
            if isinstance(step, _Fixed):
                pending.append(step)
                continue
            if pending:
                writers.append(_Run(pending))
                pending = []
            writers.append(_counted(step))
        if pending:
            writers.append(_Run(pending))
        self._writers = tuple(writers)

    def __call__(self, message: Any, parts: Parts, seq: int = 0) -> None:
        if self._seq:
            parts.append(_COUNT.pack(seq & 0xFFFFFFFF))
        for write in self._writers:
            write(message, parts)


@functools.cache
def _plan(name: str) -> _Plan:
    return _Plan(name)


def _flat(name: str, prefix: str) -> Iterator[_Fixed | _Counted]:
    """The fields of a type and its nested types, in byte order."""
    for pair in pairs(name):
        if pair.name is None:
            yield _Fixed(f"{zero_size(pair.field)}x", None)
            continue
        path = prefix + pair.name
        if pair.form == "number" and pair.field.kind == "message":
            yield from _flat(pair.field.type, f"{path}.")
        elif pair.form == "number":
            yield _Fixed(CODES[pair.field.type], path)
        else:
            yield _Counted(pair.field, path)


def zero_size(field: Field) -> int:
    """Size in bytes of a zero or empty field, whose bytes are all zero."""
    if field.array and field.length is None:
        return 4
    if field.kind == "message":
        one = sum(zero_size(pair.field) for pair in pairs(field.type))
    elif field.kind == "string":
        one = 4
    else:
        one = struct.calcsize(f"<{CODES[field.type]}")
    return one * (field.length if field.array and field.length else 1)


class _Run:
    """A sequence of numbers, packed in one call."""

    def __init__(self, fixed: list[_Fixed]) -> None:
        self._pack = struct.Struct("<" + "".join(step.code for step in fixed)).pack
        paths = [step.path for step in fixed if step.path is not None]
        self._get = attrgetter(*paths) if paths else None
        self._single = len(paths) == 1

    def __call__(self, message: Any, parts: Parts) -> None:
        if self._get is None:
            parts.append(self._pack())
        elif self._single:
            parts.append(self._pack(self._get(message)))
        else:
            parts.append(self._pack(*self._get(message)))


def _counted(step: _Counted) -> _Writer:
    get = attrgetter(step.path)
    field = step.field
    if not field.array:
        return lambda message, parts: _write_text(get(message), parts)
    if field.kind == "string":
        return _list_writer(field, get, _write_text)
    if field.kind == "message":
        return _list_writer(field, get, _plan(field.type))
    return _array_writer(field, get)


def _write_text(text: str, parts: Parts) -> None:
    data = text.encode(errors="surrogateescape")
    parts.append(_COUNT.pack(len(data)))
    parts.append(data)


def _list_writer(
    field: Field, get: Callable[[Any], Any], write: Callable[[Any, Parts], None]
) -> _Writer:
    def write_list(message: Any, parts: Parts) -> None:
        values = get(message)
        _count(field, len(values), parts)
        for value in values:
            write(value, parts)

    return write_list


def _array_writer(field: Field, get: Callable[[Any], Any]) -> _Writer:
    dtype = np.dtype(field.type).newbyteorder("<")

    def write_array(message: Any, parts: Parts) -> None:
        values = get(message)
        if type(values) is not np.ndarray or values.dtype != dtype:
            values = np.asarray(values, dtype=dtype)
        _count(field, values.size, parts)
        if values.nbytes >= _SHARED and values.flags.c_contiguous:
            parts.append(values.data)
        else:
            parts.append(values.tobytes())

    return write_array


def _count(field: Field, count: int, parts: Parts) -> None:
    if field.length is None:
        parts.append(_COUNT.pack(count))
    elif count != field.length:
        raise ValueError(f"{field.name} must have {field.length} values (got {count})")
