"""A field of a message type, and its value in a message that is created without it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

CODES = {
    "bool": "?",
    "int8": "b",
    "uint8": "B",
    "int16": "h",
    "uint16": "H",
    "int32": "i",
    "uint32": "I",
    "int64": "q",
    "uint64": "Q",
    "float32": "f",
    "float64": "d",
}
"""`struct` codes by numpy type."""

_DTYPES = {"octet": "uint8", "byte": "uint8", "char": "uint8", "float128": "longdouble"}

Kind = Literal["bool", "int", "float", "string", "message"]


@dataclass(frozen=True, kw_only=True, slots=True)
class Field:
    """A field of a message."""

    name: str
    kind: Kind
    type: str
    """numpy name of a number's type, ``string``, or the type of a nested message."""
    array: bool = False
    length: int | None = None
    """Length of an array with fixed length."""
    most: int = 0
    """Maximum length of a sequence; 0 if unlimited."""
    longest: int = 0
    """Maximum length of a string; 0 if unlimited."""
    wide: bool = False
    """Whether it is a ``wstring``, which CDR represents differently."""
    default: Any = None
    """Value of an omitted field: a value, a tuple for an array, or None for zero or empty."""

    @property
    def described(self) -> str:
        """The type as in a message definition."""
        text = f"{self.type}<={self.longest}" if self.longest else self.type
        if not self.array:
            return text
        if self.most:
            return f"{text}[<={self.most}]"
        return f"{text}[{'' if self.length is None else self.length}]"


def field_of(name: str, description: Any) -> Field:
    """Converts a field description of rosbags."""
    from rosbags.interfaces import Nodetype

    node, value = description
    if node in (Nodetype.ARRAY, Nodetype.SEQUENCE):
        inner = field_of(name, value[0])
        length = value[1] if node == Nodetype.ARRAY else None
        most = value[1] if node == Nodetype.SEQUENCE else 0
        return replace(inner, array=True, length=length, most=most or 0)
    if node == Nodetype.NAME:
        return Field(name=name, kind="message", type=value)
    base = value[0]
    if base in ("string", "wstring"):
        wide = base == "wstring"
        return Field(name=name, kind="string", type="string", longest=value[1] or 0, wide=wide)
    if base == "bool":
        return Field(name=name, kind="bool", type="bool")
    kind: Kind = "float" if base.startswith("float") else "int"
    return Field(name=name, kind=kind, type=_DTYPES.get(base, base))


def empty(field: Field, make: Callable[[str], Any]) -> Any:
    """A new value for an omitted field: its stated default, zero or empty.

    Args:
        field: The field.
        make: Creates an empty message of a type.
    """
    if field.default is not None:
        if not field.array:
            return field.default
        if field.kind == "string":
            return list(field.default)
        return np.array(field.default, dtype=field.type)
    if field.array:
        if field.kind == "message":
            return [make(field.type) for _ in range(field.length or 0)]
        if field.kind == "string":
            return [""] * (field.length or 0)
        return np.zeros(field.length or 0, dtype=field.type)
    if field.kind == "message":
        return make(field.type)
    return _ZEROS[field.kind]


_ZEROS: dict[Kind, Any] = {"string": "", "bool": False, "int": 0, "float": 0.0}
