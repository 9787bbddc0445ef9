"""Messages as CDR bytes. Each type is compiled once into a plan that packs it in a few calls.

CDR aligns numbers to multiples of their size, counted from the end of the encapsulation. The
same sequence of numbers therefore has eight layouts, depending on its offset.

Source: DDS-XTypes, plain CDR of version 1, little endian.
"""

from __future__ import annotations

import functools
import struct
from collections.abc import Callable, Iterator
from operator import attrgetter
from typing import Any

import numpy as np

from cartwheel.codes.graph import MESSAGE_NOT_ENCODABLE
from cartwheel.errors import GraphError
from cartwheel.messages.cdr.compiled import (
    Encoder,
    Writer,
    compiled_encoder,
    compiled_writer,
)
from cartwheel.messages.cdr.layouts import check_count
from cartwheel.messages.classes import FILLER
from cartwheel.messages.field import CODES, Field, field_of
from cartwheel.messages.store import loaded, message_class

_SHARED = 4096
"""Minimum size in bytes of an array that is passed on without a copy."""
_SHORT = 64
"""Maximum length in characters of a string whose encoding is cached, such as a frame name."""

_Parts = list[Any]
"""Bytes and views of arrays, to be joined."""


def encode_cdr(message: Any) -> bytes:
    """Encodes a message as CDR with four bytes of encapsulation, as in ROS 2 and MCAP.

    Raises:
        GraphError: A value does not fit its field.
    """
    try:
        return _encoders[message.__class__](message)
    except (struct.error, TypeError, AttributeError, ValueError, OverflowError) as error:
        raise GraphError(
            f"ROS 2 cannot represent this {message.__msgtype__}: {error}",
            code=MESSAGE_NOT_ENCODABLE,
            values={"type": message.__msgtype__},
        ) from error


class _Plan:
    """Writes messages of one type."""

    def __init__(self, name: str) -> None:
        writers: list[Writer] = []
        row: list[tuple[str, str]] = []
        for path, field, code in _flat(name, ""):
            if code:
                row.append((code, path))
                continue
            if row:
                writers.append(_Row(row))
                row = []
            writers.append(_counted(field, path))
        if row:
            writers.append(_Row(row))
        self._writers = tuple(writers)

    def __call__(self, message: Any, parts: _Parts, at: int) -> int:
        for write in self._writers:
            at = write(message, parts, at)
        return at


@functools.cache
def _plan(name: str) -> Writer:
    return compiled_writer(list(_flat(name, "")), _Plan(name), _plan)


class _Encoders(dict[type, Encoder]):
    """Encoders by the class of messages, which is found faster than by the name of the type."""

    def __missing__(self, kind: Any) -> Encoder:
        name = kind.__msgtype__
        made = self[kind] = compiled_encoder(list(_flat(name, "")), _Plan(name), _plan)
        return made


_encoders = _Encoders()


def _flat(name: str, prefix: str) -> Iterator[tuple[str, Field, str]]:
    """The fields of a type and its nested types, in byte order.

    Yields:
        The path of a field, the field, and the `struct` code if it is a number.
    """
    full = message_class(name).__msgtype__
    for own, description in loaded().fielddefs[full][1]:
        field = field_of(own, description)
        if field.array or field.kind == "string":
            yield prefix + own, field, ""
        elif field.kind == "message":
            yield from _flat(field.type, f"{prefix}{own}.")
        elif own == FILLER:
            yield prefix + own, field, "x"
        else:
            # rosbags reads a single byte as signed.
            yield prefix + own, field, "b" if description[1][0] == "byte" else CODES[field.type]


class _Row:
    """A sequence of numbers, packed in one call."""

    def __init__(self, numbers: list[tuple[str, str]]) -> None:
        codes = [code for code, _ in numbers]
        self._ways = tuple(_aligned(codes, start) for start in range(8))
        paths = [path for code, path in numbers if code != "x"]
        self._get = attrgetter(*paths) if paths else None
        self._single = len(paths) == 1

    def __call__(self, message: Any, parts: _Parts, at: int) -> int:
        way = self._ways[at & 7]
        if self._get is None:
            parts.append(way.pack())
        elif self._single:
            parts.append(way.pack(self._get(message)))
        else:
            parts.append(way.pack(*self._get(message)))
        return at + way.size


def _aligned(codes: list[str], start: int) -> struct.Struct:
    """Layout of numbers from an offset on, with padding."""
    form, at = "<", start
    for code in codes:
        size = struct.calcsize(f"<{code}")
        gap = -at % size
        form += f"{gap}x{code}"
        at += gap + size
    return struct.Struct(form)


_COUNTS = tuple(_aligned(["I"], start) for start in range(4))


def _counted(field: Field, path: str) -> Writer:
    get = attrgetter(path)
    write = _wide_text_writer if field.wide else _text_writer
    if not field.array:
        return write(get)
    if field.kind == "string":
        return _list_writer(field, get, write(lambda text: text))
    if field.kind == "message":
        return _list_writer(field, get, _plan(field.type))
    return _array_writer(field, get)


def _text(text: str, start: int) -> bytes:
    data = text.encode()
    return b"%b%b\0" % (_COUNTS[start].pack(len(data) + 1), data)


_short_text = functools.lru_cache(maxsize=1024)(_text)


def _text_writer(get: Callable[[Any], Any]) -> Writer:
    def write_text(message: Any, parts: _Parts, at: int) -> int:
        text = get(message)
        made = _short_text(text, at & 3) if len(text) <= _SHORT else _text(text, at & 3)
        parts.append(made)
        return at + len(made)

    return write_text


def _wide_text_writer(get: Callable[[Any], Any]) -> Writer:
    """ROS 2 writes each UTF-16 code unit as four bytes. Source: rosidl_typesupport_fastrtps."""

    def write_text(message: Any, parts: _Parts, at: int) -> int:
        units = np.frombuffer(get(message).encode("utf-16-le", "surrogatepass"), dtype="<u2")
        way = _COUNTS[at & 3]
        parts.append(way.pack(units.size))
        parts.append(units.astype("<u4").tobytes())
        return at + way.size + 4 * units.size

    return write_text


def _list_writer(field: Field, get: Callable[[Any], Any], write: Writer) -> Writer:
    def write_list(message: Any, parts: _Parts, at: int) -> int:
        values = get(message)
        at = _write_count(field, len(values), parts, at)
        for value in values:
            at = write(value, parts, at)
        return at

    return write_list


def _array_writer(field: Field, get: Callable[[Any], Any]) -> Writer:
    dtype = np.dtype(field.type).newbyteorder("<")
    last = dtype.itemsize - 1

    def write_array(message: Any, parts: _Parts, at: int) -> int:
        values = get(message)
        if type(values) is not np.ndarray or values.dtype != dtype:
            values = np.asarray(values, dtype=dtype)
        at = _write_count(field, values.size, parts, at)
        size: int = values.nbytes
        if not size:
            return at
        gap = -at & last
        if gap:
            parts.append(bytes(gap))
        shared = size >= _SHARED and values.flags.c_contiguous
        parts.append(values.data if shared else values.tobytes())
        return at + gap + size

    return write_array


def _write_count(field: Field, count: int, parts: _Parts, at: int) -> int:
    check_count(field, count)
    if field.length is None:
        way = _COUNTS[at & 3]
        parts.append(way.pack(count))
        return at + way.size
    return at
