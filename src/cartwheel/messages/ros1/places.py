"""Places of numbers in ROS 1 bytes, which depend on the strings and lengths of the message."""

from __future__ import annotations

import struct
from typing import Any

from cartwheel.messages.field import CODES, Field
from cartwheel.messages.places import Place
from cartwheel.messages.ros1.fields import HEADER, pairs
from cartwheel.messages.ros1.writing import zero_size

SEQ = "seq"
"""Path of the sequence number of the header with which a message begins."""


def ros1_places(message: Any) -> list[Place]:
    """The places of all numbers of a message in the bytes of `encode_ros1`, in order.

    Raises:
        UnknownNameError: ROS 1 does not have this type.
    """
    found: list[Place] = []
    known = pairs(message.__msgtype__)
    if known and known[0].field.type == HEADER and not known[0].field.array:
        found.append(Place(SEQ, 0, "I"))
    _read(message, "", 0, found)
    return found


def _read(message: Any, prefix: str, at: int, found: list[Place]) -> int:
    for pair in pairs(message.__msgtype__):
        field = pair.field
        if pair.name is None:
            at += zero_size(field)
            continue
        value, path = getattr(message, pair.name), prefix + pair.name
        code = "" if field.kind in ("string", "message") else CODES[field.type]
        if not field.array:
            at = _read_one(field, value, Place(path, at, code), found)
            continue
        if field.length is None:
            at += 4
        if not code:
            for index, each in enumerate(value):
                at = _read_one(field, each, Place(f"{path}.{index}", at, code), found)
        else:
            found.append(Place(path, at, code, len(value)))
            at += len(value) * struct.calcsize(f"<{code}")
    return at


def _read_one(field: Field, value: Any, place: Place, found: list[Place]) -> int:
    """Adds the places of one value, of which `place` has the path and the previous offset."""
    path, at, code = place.path, place.at, place.code
    if field.kind == "message":
        return _read(value, f"{path}.", at, found)
    if field.kind == "string":
        return at + 4 + len(value.encode(errors="surrogateescape"))
    found.append(Place(path, at, code))
    return at + struct.calcsize(f"<{code}")
