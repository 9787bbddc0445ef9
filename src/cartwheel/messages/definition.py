"""Definitions of message types, as files and other processes contain them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, Literal

from cartwheel.errors import Origin

Dialect = Literal["ros1", "ros2", "both"]
"""The ROS version of a definition. ``both``: it has the same meaning in both versions."""
RECORDING = "<recording>"
"""The file name of definitions from recordings."""
Scalar = bool | int | float | str

TIMES = {"time": "builtin_interfaces/msg/Time", "duration": "builtin_interfaces/msg/Duration"}
"""The types that ROS 1 has instead of messages."""
_ROS1_TIMES = {message: name for name, message in TIMES.items()}
_GRAPH = {"byte": "uint8", "char": "uint8"}
"""Number types in the graph."""


@dataclass(frozen=True, kw_only=True, slots=True)
class DefinedConstant:
    """A constant of a message type."""

    type: str
    """As in the definition."""
    name: str
    value: Scalar
    text: str
    """The value as in the definition, which ROS 1 hashes."""


@dataclass(frozen=True, kw_only=True, slots=True)
class DefinedField:
    """A field of a message type."""

    name: str
    type: str
    """A primitive type as in the definition, or the full name of a message type."""
    line: int
    longest: int = 0
    """Maximum length of a string; 0 if unlimited."""
    array: bool = False
    length: int | None = None
    """Length of a fixed array."""
    most: int = 0
    """Maximum length of a sequence; 0 if unlimited."""
    default: Scalar | tuple[Scalar, ...] | None = None
    default_text: str = ""
    """The default value as in the definition."""

    @property
    def is_message(self) -> bool:
        """Whether the type is a message type."""
        return "/" in self.type

    @property
    def is_text(self) -> bool:
        """Whether the type is a kind of string."""
        return self.type in ("string", "wstring")

    def described(self, *, hashed: bool = False, bounded: bool = True, signed: bool = False) -> Any:
        """The type in the form of rosbags.

        Args:
            hashed: Whether ``byte`` keeps its name, as in the hashes of ROS 2.
            bounded: Whether to include maximum lengths, which ROS 1 does not have.
            signed: Whether a ``byte`` is signed, as in ROS 1.
        """
        from rosbags.interfaces import Nodetype

        one: Any
        if self.is_message:
            one = (Nodetype.NAME, self.type)
        else:
            base = self.type if hashed else _GRAPH.get(self.type, self.type)
            if self.type == "byte" and signed and not hashed:
                base = "int8"
            one = (Nodetype.BASE, (base, self.longest if bounded else 0))
        if not self.array:
            return one
        if self.length is not None:
            return (Nodetype.ARRAY, (one, self.length))
        return (Nodetype.SEQUENCE, (one, self.most if bounded else 0))

    @property
    def brackets(self) -> str:
        """The length of an array without a maximum, as in ROS 1."""
        if not self.array:
            return ""
        return f"[{'' if self.length is None else self.length}]"

    def written(self, version: Literal[1, 2]) -> str:
        """The line of the definition for a version of ROS."""
        if version == 1:
            base = _ROS1_TIMES.get(self.type) or short_name(self.type)
            return f"{base}{self.brackets} {self.name}"
        base = short_name(self.type) + (f"<={self.longest}" if self.longest else "")
        array = f"[<={self.most}]" if self.most else self.brackets
        default = f" {self.default_text}" if self.default_text else ""
        return f"{base}{array} {self.name}{default}"


@dataclass(frozen=True, kw_only=True, slots=True)
class Definition:
    """A message type, or a part of a service or action type."""

    name: str
    """``pkg/msg/Name``, ``pkg/srv/Name_Request``, ``pkg/action/Name_Goal``, …"""
    dialect: Dialect
    text: str
    """The definition without nested types."""
    origin: Origin = field(compare=False)
    """The file and line at which the definition begins."""
    constants: tuple[DefinedConstant, ...] = ()
    fields: tuple[DefinedField, ...] = ()

    @property
    def uses(self) -> tuple[DefinedField, ...]:
        """The fields whose type is a message type."""
        return tuple(each for each in self.fields if each.is_message)

    @property
    def has_wide_text(self) -> bool:
        """Whether a field is a ``wstring``, which ROS 1 does not have."""
        return any(each.type == "wstring" for each in self.fields)

    def fielddefs(self, *, hashed: bool = False, bounded: bool = True) -> Any:
        """Constants and fields in the form of rosbags."""
        constants = [(c.name, _GRAPH.get(c.type, c.type), c.value) for c in self.constants]
        signed = self.dialect == "ros1"
        return constants, [
            (each.name, each.described(hashed=hashed, bounded=bounded, signed=signed))
            for each in self.fields
        ]

    def same_as(self, other: Definition) -> bool:
        """Whether two definitions have the same fields, and the same constants in files.

        Recordings and files write the values of constants differently.
        """
        if RECORDING in (self.origin.file, other.origin.file):
            return bool(self.shape[1] == other.shape[1])
        return bool(self.shape == other.shape)

    @property
    def shape(self) -> Any:
        """What distinguishes two definitions: values of constants, types and names of fields."""
        return (
            sorted((each.name, each.type, each.value) for each in self.constants),
            [(f.name, f.type, f.longest, f.array, f.length, f.most) for f in self.fields],
        )

    def written(self, version: Literal[1, 2]) -> str:
        """The definition for a version of ROS: the original text, if it is valid there."""
        if self.dialect in ("both", f"ros{version}"):
            return self.text if self.text.endswith("\n") or not self.text else f"{self.text}\n"
        return "".join(f"{line}\n" for line in self.lines(version))

    def lines(self, version: Literal[1, 2]) -> Iterator[str]:
        """The lines of the definition, without comments, for a version of ROS."""
        for each in self.constants:
            value = each.text
            if each.type in ("string", "wstring"):
                value = str(each.value) if version == 1 else quoted(str(each.value))
            yield f"{each.type} {each.name}={value}"
        for one in self.fields:
            yield one.written(version)


def quoted(text: str) -> str:
    """A string as ROS 2 writes it in a definition."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'


def short_name(name: str) -> str:
    """``pkg/msg/Name`` as ``pkg/Name``, as in definitions. Other names stay as they are."""
    package, slash, rest = name.partition("/")
    return f"{package}/{rest.removeprefix('msg/')}" if slash else name
