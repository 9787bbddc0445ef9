"""Parsing of ``.msg`` definitions in the dialects of ROS 1 and ROS 2.

The files come from anywhere, so all sizes are bounded, and each error has a file and a line.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import NoReturn

from cartwheel.codes.graph import MESSAGE_DEFINITION_INVALID
from cartwheel.errors import GraphError, Origin, Value
from cartwheel.messages.definition import (
    TIMES,
    DefinedConstant,
    DefinedField,
    Definition,
    Dialect,
    Scalar,
)

LARGEST = 1 << 20
"""Maximum size of a file in bytes."""
MOST_FIELDS = 2000
"""Maximum number of fields and constants of a type."""
LONGEST_ARRAY = 10_000
"""Maximum length of a fixed array of strings or messages, for which rosbags generates code."""
MOST_NUMBERS = 1 << 26
"""Maximum length of a fixed array of numbers."""
MOST_BOUND = (1 << 32) - 1
"""Maximum length of a bounded sequence or string."""
_LONGEST_NAME = 255

_INTEGERS = {
    **{f"int{bits}": (-(1 << bits - 1), (1 << bits - 1) - 1) for bits in (8, 16, 32, 64)},
    **{f"uint{bits}": (0, (1 << bits) - 1) for bits in (8, 16, 32, 64)},
    "char": (0, 255),
    "byte": (0, 255),
}
_PRIMITIVES = {*_INTEGERS, "bool", "float32", "float64", "string", "wstring"}
_TYPE = re.compile(
    r"(?P<base>[A-Za-z]\w*(?:/[A-Za-z]\w*){0,2})(?:<=(?P<longest>\d{1,10}))?"
    r"(?P<array>\[(?P<bound><=)?(?P<size>\d{0,10})\])?(?=\s)",
    re.ASCII,
)
_NAME = re.compile(r"\s+([A-Za-z]\w*)\s*", re.ASCII)
_WORD = re.compile(r"[A-Za-z]\w*\Z", re.ASCII)
_PACKAGE = re.compile(r"[a-z]\w*\Z", re.ASCII | re.IGNORECASE)
_QUOTED = re.compile(r"\"(?:[^\"\\]|\\.)*\"|'(?:[^'\\]|\\.)*'", re.DOTALL)
_INTEGER = re.compile(r"[+-]?(?:0[xX][0-9a-fA-F]+|0[bB][01]+|0[oO][0-7]+|[0-9]+)\Z")
_ITEM = re.compile(r"\s*(\"(?:[^\"\\]|\\.)*\"|'(?:[^'\\]|\\.)*'|[^,\"'\s]+)\s*(,|\Z)")
_LONGEST_NUMBER = 400
_TAKEN = frozenset({"__msgtype__"})


def is_type_name(name: str) -> bool:
    """Whether this is the name of a type ``pkg/msg/Name``, which may be part of a file name."""
    parts = name.split("/")
    return (
        len(parts) == 3
        and parts[1] in ("msg", "srv", "action")
        and len(name) <= _LONGEST_NAME
        and _PACKAGE.match(parts[0]) is not None
        and _WORD.match(parts[2]) is not None
    )


def decode_text(data: bytes, origin: Origin) -> str:
    """The text of a file.

    Raises:
        GraphError: The file is too large or not valid UTF-8.
    """
    if len(data) > LARGEST:
        _fail(f"the file is larger than {LARGEST} bytes", origin, {"bytes": len(data)})
    try:
        return data.decode("utf-8-sig").replace("\r\n", "\n").replace("\r", "\n")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        _fail("the file is not valid UTF-8", Origin(file=origin.file, line=line), {})


def parse_definition(
    name: str,
    text: str,
    origin: Origin,
    *,
    dialect: Dialect | None = None,
    own_header: bool = False,
) -> Definition:
    """Parses the definition of a message type, or of a part of a service or action.

    Args:
        name: Full name of the type.
        text: Definition without nested types.
        origin: File and line at which the text begins.
        dialect: Version of ROS; None derives it from the definition.
        own_header: Whether the package defines a type ``Header`` itself.

    Raises:
        GraphError: The definition is invalid. The error names the file and line.
    """
    return _Parser(name, text, origin, dialect, own_header).parse()


@dataclass(frozen=True, slots=True)
class _Sign:
    """Something that only one version of ROS has."""

    what: str
    line: int


class _Parser:
    """Parses one definition."""

    def __init__(
        self, name: str, text: str, origin: Origin, dialect: Dialect | None, own_header: bool
    ) -> None:
        self._name = name
        self._text = text
        self._origin = origin
        self._dialect = dialect
        self._own_header = own_header
        self._line = 0
        self._signs: dict[str, _Sign] = {}
        """The first sign of each version."""
        self._constants: list[DefinedConstant] = []
        self._fields: list[DefinedField] = []
        self._names: set[str] = set()

    def parse(self) -> Definition:
        if self._dialect in ("ros1", "ros2"):
            self._signs[self._dialect] = _Sign("", 0)
        for number, line in self._content():
            self._line = number
            self._read(line)
            if len(self._names) > MOST_FIELDS:
                self._fail(f"the type has more than {MOST_FIELDS} fields and constants")
        dialect = next(iter(self._signs), "both")
        return Definition(
            name=self._name,
            dialect="ros1" if dialect == "ros1" else "ros2" if dialect == "ros2" else "both",
            text=self._text,
            origin=self._origin,
            constants=tuple(self._constants),
            fields=tuple(self._fields),
        )

    def _content(self) -> Iterator[tuple[int, str]]:
        """The lines that are not empty or comments, with their numbers in the file."""
        for number, line in enumerate(self._text.split("\n"), max(self._origin.line, 1)):
            stripped = line.strip()
            if stripped and not stripped.startswith(("#", "@")):
                yield number, stripped

    def _read(self, line: str) -> None:
        # The type ends at a space, so add one after the last word.
        match = _TYPE.match(f"{line} ")
        if match is None:
            self._fail(f"{_shown(line)} is not a field or a constant")
        base = match["base"]
        rest = line[match.end() :]
        named = _NAME.match(rest)
        if named is None:
            self._fail(f"{_shown(line)} has no valid field name")
        name = named[1]
        if len(name) > _LONGEST_NAME or name in _TAKEN:
            self._fail(f"{_shown(name)} is not a valid field name", {"name": name[:_LONGEST_NAME]})
        rest = rest[named.end() :]
        if name in self._names:
            self._fail(f'two fields or constants have the name "{name}"', {"name": name})
        self._names.add(name)
        if rest.startswith("="):
            if match["longest"] or match["array"] or base not in _PRIMITIVES:
                self._fail(
                    f'the constant "{name}" must have a primitive type without a length',
                    {"name": name},
                )
            self._constants.append(self._constant(base, name, rest[1:].strip()))
            return
        self._fields.append(self._field(match, name, _without_comment(rest)))

    # -- fields

    def _field(self, match: re.Match[str], name: str, default: str) -> DefinedField:
        base, longest = match["base"], match["longest"]
        kind = self._type(base)
        if longest is not None:
            if kind not in ("string", "wstring"):
                self._fail(
                    f'only strings can have a maximum length, but "{name}" has the type {base}'
                )
            self._sign("ros2", f'the maximum length of "{name}"')
        length: int | None = None
        most = 0
        if match["array"]:
            size = match["size"]
            if match["bound"]:
                self._sign("ros2", f'the maximum length of "{name}"')
                most = self._size(name, size, MOST_BOUND)
            elif size:
                plain = "/" not in kind and kind not in ("string", "wstring")
                length = self._size(name, size, MOST_NUMBERS if plain else LONGEST_ARRAY)
        if kind == "wstring":
            self._sign("ros2", "wstring")
        made = DefinedField(
            name=name,
            type=kind,
            line=self._line,
            longest=self._size(name, longest, MOST_BOUND) if longest is not None else 0,
            array=match["array"] is not None,
            length=length,
            most=most,
        )
        return self._with_default(made, default) if default else made

    def _size(self, name: str, size: str | None, most: int) -> int:
        value = int(size) if size else 0
        if not 1 <= value <= most:
            self._fail(
                f'the length of "{name}" must be between 1 and {most} (got {value})', {"name": name}
            )
        return value

    def _type(self, base: str) -> str:
        """A primitive type, or the full name of a message type."""
        if base in _PRIMITIVES:
            return base
        if base in TIMES:
            self._sign("ros1", base)
            return TIMES[base]
        parts = base.split("/")
        package = self._name.partition("/")[0]
        if base == "Header" and not self._own_header and self._dialect != "ros2":
            return "std_msgs/msg/Header"
        if len(parts) == 1:
            full = f"{package}/msg/{base}"
        elif len(parts) == 2:
            full = f"{parts[0]}/msg/{parts[1]}"
        else:
            full = base
        if not is_type_name(full) or "/srv/" in full:
            self._fail(f'"{base}" is not a valid ROS type', {"type": base})
        return full

    def _with_default(self, made: DefinedField, text: str) -> DefinedField:
        self._sign("ros2", f'the default value of "{made.name}"')
        if made.is_message:
            self._fail(f'"{made.name}" is a message and cannot have a default value')
        default: Scalar | tuple[Scalar, ...]
        if made.array:
            items = tuple(self._items(text, made))
            if made.length is not None and len(items) != made.length:
                self._fail(f'"{made.name}" has {made.length} values, but {len(items)} defaults')
            if made.most and len(items) > made.most:
                self._fail(f'"{made.name}" has at most {made.most} values, but more defaults')
            default = items
        else:
            default = self._value(made.type, made.name, text)
        texts = default if isinstance(default, tuple) else (default,)
        if made.longest and any(len(str(each)) > made.longest for each in texts):
            self._fail(f'the default value of "{made.name}" is longer than {made.longest}')
        return DefinedField(
            name=made.name,
            type=made.type,
            line=made.line,
            longest=made.longest,
            array=made.array,
            length=made.length,
            most=made.most,
            default=default,
            default_text=text,
        )

    def _items(self, text: str, made: DefinedField) -> Iterator[Scalar]:
        if not (text.startswith("[") and text.endswith("]")):
            self._fail(f'the default value of "{made.name}" must be a list', {"name": made.name})
        inner, at = text[1:-1].strip(), 0
        while at < len(inner):
            match = _ITEM.match(inner, at)
            if match is None:
                self._fail(f'the default value of "{made.name}" is not a valid list')
            yield self._value(made.type, made.name, match[1])
            at = match.end()

    # -- values

    def _constant(self, base: str, name: str, raw: str) -> DefinedConstant:
        if base in ("string", "wstring"):
            # In ROS 1, the value extends to the end of the line, including quotes and comments.
            quoted = _QUOTED.match(raw) if self._dialect != "ros1" else None
            value: Scalar = raw
            if quoted:
                value = _unquoted(quoted[0])
            elif self._dialect == "ros2":
                value = _without_comment(raw)
            text = raw
        else:
            text = _without_comment(raw)
            value = self._value(base, name, text)
        return DefinedConstant(type=base, name=name, value=value, text=text)

    def _value(self, base: str, name: str, text: str) -> Scalar:
        value = _scalar(base, text)
        least, most = _INTEGERS.get(base, (0, 0))
        if base == "byte" and self._dialect != "ros2":
            least = -128
        if value is None or (base in _INTEGERS and not least <= int(value) <= most):
            self._fail(f'"{name}": {_shown(text)} is not a valid {base}', {"name": name})
        return value

    # -- dialects

    def _sign(self, version: str, what: str) -> None:
        """Notes something that only one version of ROS has."""
        other = "ros2" if version == "ros1" else "ros1"
        if (opposite := self._signs.get(other)) is not None:
            title = {"ros1": "ROS 1", "ros2": "ROS 2"}
            because = (
                f"line {opposite.line} ({opposite.what})" if opposite.line else "the package's type"
            )
            hint = (
                "Use builtin_interfaces/Time or builtin_interfaces/Duration."
                if version == "ros1"
                else "Remove it, or make the package a ROS 2 package in package.xml."
            )
            self._fail(
                f"{what} exists only in {title[version]}, but this is a definition for "
                f"{title[other]} because of {because}",
                {"what": what},
                hint=hint,
            )
        self._signs.setdefault(version, _Sign(what, self._line))

    def _fail(
        self, message: str, values: dict[str, Value] | None = None, hint: str | None = None
    ) -> NoReturn:
        origin = Origin(file=self._origin.file, line=self._line or self._origin.line)
        _fail(message, origin, {"type": self._name, **(values or {})}, hint)


_PREFIXES = ("0x", "0b", "0o")


def _fail(
    message: str, origin: Origin, values: dict[str, Value], hint: str | None = None
) -> NoReturn:
    raise GraphError(
        message, code=MESSAGE_DEFINITION_INVALID, origin=origin, values=values, hint=hint
    )


def _without_comment(text: str) -> str:
    """The text before a comment. Strings may contain ``#``."""
    at, unclosed = 0, ""
    for start in re.finditer("[\"'#]", text):
        if start.start() < at or start[0] in unclosed:
            continue
        if start[0] == "#":
            return text[: start.start()].strip()
        quoted = _QUOTED.match(text, start.start())
        if quoted is None:
            # Searching again from each later quote would take quadratic time.
            unclosed += start[0]
        else:
            at = quoted.end()
    return text.strip()


def _unquoted(text: str) -> str:
    return re.sub(r"\\(.)", r"\1", text[1:-1], flags=re.DOTALL)


def _scalar(base: str, text: str) -> Scalar | None:
    """A value of a primitive type; None if it is invalid."""
    if base in ("string", "wstring"):
        return _unquoted(text) if len(text) > 1 and _QUOTED.fullmatch(text) else text
    if base == "bool":
        return {"true": True, "1": True, "false": False, "0": False}.get(text.lower())
    if len(text) > _LONGEST_NUMBER:
        return None
    if base in ("float32", "float64"):
        try:
            return None if "_" in text else float(text)
        except ValueError:
            return None
    if not _INTEGER.match(text):
        return None
    return int(text, 0) if text.lstrip("+-")[:2].lower() in _PREFIXES else int(text)


def _shown(text: str) -> str:
    return f'"{text}"' if len(text) <= 60 else f'"{text[:57]}…"'
