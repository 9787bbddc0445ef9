"""Places of numbers in CDR bytes, which depend on the strings and lengths of the message."""

from __future__ import annotations

import functools
import struct
from typing import Any

from cartwheel.messages.cdr.layouts import HEAD
from cartwheel.messages.cdr.reading import has_wide_text
from cartwheel.messages.classes import FILLER
from cartwheel.messages.field import CODES, Field, field_of
from cartwheel.messages.places import Place
from cartwheel.messages.store import loaded


def cdr_places(message: Any) -> list[Place]:
    """The places of all numbers of a message in the bytes of `encode_cdr`, in order.

    Raises:
        ValueError: The type contains a wide string.
    """
    if has_wide_text(message.__msgtype__):
        raise ValueError(f"{message.__msgtype__} contains a wide string")
    found: list[Place] = []
    _read(message, "", len(HEAD), found)
    return found


def _read(message: Any, prefix: str, at: int, found: list[Place]) -> int:
    for field, code in _fields(message.__msgtype__):
        if field.name == FILLER:
            at += 1
            continue
        value, path = getattr(message, field.name), prefix + field.name
        if not field.array:
            at = _read_one(field, value, Place(path, at, code), found)
            continue
        if field.length is None:
            at = _aligned(at, 4) + 4
        if not code:
            for index, each in enumerate(value):
                at = _read_one(field, each, Place(f"{path}.{index}", at, code), found)
        else:
            size = struct.calcsize(f"<{code}")
            if len(value):
                at = _aligned(at, size)
            found.append(Place(path, at, code, len(value)))
            at += len(value) * size
    return at


@functools.cache
def _fields(name: str) -> list[tuple[Field, str]]:
    """The fields of a type with their `struct` codes."""
    found = []
    for own, description in loaded().fielddefs[name][1]:
        field = field_of(own, description)
        code = "" if field.kind in ("string", "message") else CODES[field.type]
        # As in `cartwheel.messages.cdr.writing`.
        found.append((field, "b" if description[1][0] == "byte" else code))
    return found


def _read_one(field: Field, value: Any, place: Place, found: list[Place]) -> int:
    """Adds the places of one value, of which `place` has the path and the previous offset."""
    path, at, code = place.path, place.at, place.code
    if field.kind == "message":
        return _read(value, f"{path}.", at, found)
    if field.kind == "string":
        return _aligned(at, 4) + 4 + len(value.encode()) + 1
    size = struct.calcsize(f"<{code}")
    at = _aligned(at, size)
    found.append(Place(path, at, code))
    return at + size


def _aligned(at: int, size: int) -> int:
    """The next offset at a multiple of a size, counted from the end of the encapsulation."""
    return at + -(at - len(HEAD)) % size
