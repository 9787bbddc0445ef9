"""Hashes of message types in ROS 2. Source: REP 2016."""

from __future__ import annotations

import hashlib
import json
from typing import Any

_ARRAY, _BOUNDED, _UNBOUNDED = 48, 96, 144
"""Offsets of array kinds, which are added to the type's number. Source: FieldType.msg."""
_NESTED, _BOUNDED_TEXT = 1, 4
"""Number of nested types, and the offset of strings with a maximum length."""
_NUMBERS = {
    "int8": 2,
    "uint8": 3,
    "int16": 4,
    "uint16": 5,
    "int32": 6,
    "uint32": 7,
    "int64": 8,
    "uint64": 9,
    "float32": 10,
    "float64": 11,
    "float128": 12,
    "char": 13,
    "wchar": 14,
    "bool": 15,
    "byte": 16,
    "octet": 16,
    "string": 17,
    "wstring": 18,
}
_FILLER = "structure_needs_at_least_one_member"


def rihs01(known: Any, name: str) -> str:
    """Hash of a type, ``RIHS01_…``.

    Args:
        known: Fields of all types, in the form of rosbags.
        name: Name of the type.
    """
    described: dict[str, Any] = {}
    waiting = [name]
    while waiting:
        one = waiting.pop()
        if one in described:
            continue
        fields = [_field(field, kind) for field, kind in known[one][1]]
        described[one] = {"type_name": one, "fields": fields or [_field(_FILLER, _BYTE)]}
        waiting += filter(None, (field["type"]["nested_type_name"] for field in fields))
    own = described.pop(name)
    whole = {
        "type_description": own,
        "referenced_type_descriptions": [described[each] for each in sorted(described)],
    }
    return f"RIHS01_{hashlib.sha256(json.dumps(whole).encode()).hexdigest()}"


_BYTE = (1, ("uint8", 0))


def _field(name: str, kind: Any) -> dict[str, Any]:
    return {"name": name, "type": field_type(kind)}


def field_type(kind: Any) -> dict[str, Any]:
    """The members of the ROS 2 message ``FieldType`` for a field in the form of rosbags."""
    from rosbags.interfaces import Nodetype

    node, value = kind
    more, capacity = 0, 0
    if node in (Nodetype.ARRAY, Nodetype.SEQUENCE):
        (inner, value), capacity = value
        more = _ARRAY if node == Nodetype.ARRAY else _BOUNDED if capacity else _UNBOUNDED
        node = inner
    nested, longest = "", 0
    if node == Nodetype.NAME:
        nested, number = value, _NESTED
    else:
        base, longest = value
        number = _NUMBERS[base] + (_BOUNDED_TEXT if longest else 0)
    return {
        "type_id": number + more,
        "capacity": capacity,
        "string_capacity": longest,
        "nested_type_name": nested,
    }
