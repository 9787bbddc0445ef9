"""Fields of message types, read once per type."""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace
from typing import Any, Literal

from cartwheel.messages.classes import FILLER
from cartwheel.messages.learnt import learnt
from cartwheel.messages.store import loaded, message_class

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


@functools.cache
def fields(name: str) -> tuple[Field, ...]:
    """Fields of a message type in order, without the filler of an empty message.

    Raises:
        UnknownNameError: The type does not exist.
    """
    full = message_class(name).__msgtype__
    definition = learnt(full)
    stated = () if definition is None else definition.fields
    defaults = {field.name: field.default for field in stated}
    return tuple(
        replace(field_of(field, description), default=defaults.get(field))
        for field, description in loaded().fielddefs[full][1]
        if field != FILLER
    )


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
