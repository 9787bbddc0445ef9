"""Generated functions that pack messages as CDR: one `struct` call for each part without lists.

The layout of a part depends on its offset and on the lengths of its strings and arrays. Messages of
one topic rarely differ in these, so the layouts and the bytes of strings are cached.
"""

from __future__ import annotations

import keyword
import struct
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from cartwheel.messages.field import CODES, Field

Writer = Callable[[Any, list[Any], int], int]
"""Writes a message at an offset: appends its parts to a list, and returns the offset after it."""

_SHORT = 64
"""Maximum length in characters of a cached string, such as a frame name."""
_SMALL = 512
"""Number of elements from which an array is left to another writer, which does not copy it."""
_KEPT = 256
"""Maximum number of cached layouts of a part."""
_FIRST = "m"
"""Name of the message in the generated code."""


@dataclass(slots=True)
class _Part:
    """Successive fields that one call packs."""

    items: list[_Item] = field(default_factory=list)
    listed: _Item | None = None
    """The list of messages that follows the part."""


@dataclass(frozen=True, slots=True)
class _Item:
    """A field, and the expression that reads it in the generated code."""

    field: Field
    value: str
    code: str = ""
    """`struct` code of a number."""

    @property
    def is_text(self) -> bool:
        return self.field.kind == "string"


def compiled(
    flat: Sequence[tuple[str, Field, str]], write_others: Writer, writer_of: Callable[[str], Writer]
) -> Writer | None:
    """Compiles the writer of a message type. None if a field is not supported.

    Args:
        flat: Path, description and `struct` code of each field, in byte order.
        write_others: Writes messages with long strings or large arrays.
        writer_of: Returns the writer of a nested type.
    """
    if not all(_is_supported(path, described) for path, described, _ in flat):
        return None
    source = _Source(flat, writer_of)
    names = source.names | {"others": write_others, "asarray": np.asarray, "ndarray": np.ndarray}
    exec(source.text, names)  # noqa: S102 - the names in it are identifiers
    write: Writer = names["write"]
    return write


def _is_supported(path: str, described: Field) -> bool:
    names = path.split(".")
    if described.wide or any(map(keyword.iskeyword, names)):
        return False
    if not all(map(str.isidentifier, names)):
        return False
    return described.kind in ("string", "message") or described.type in CODES


class _Source:
    """Source text of the writer of a message type."""

    def __init__(
        self, flat: Sequence[tuple[str, Field, str]], writer_of: Callable[[str], Writer]
    ) -> None:
        self.names: dict[str, Any] = {}
        """Global names of the text."""
        self._lines: list[str] = []
        self._read: dict[str, str] = {"": _FIRST}
        """Local variables, by the path of the value."""
        self._parts = [_Part()]
        for path, described, code in flat:
            self._add(path, described, code)
        for number, part in enumerate(self._parts):
            if part.items or part.listed is not None:
                self._pack(number, part, writer_of)
        lines = ("start, mark = at, len(parts)", *self._lines, "return at")
        self.text = "\n    ".join((f"def write({_FIRST}, parts, at):", *lines))

    def _add(self, path: str, described: Field, code: str) -> None:
        if code:
            value = "" if code == "x" else self._expression(path)
            self._parts[-1].items.append(_Item(described, value, code))
            return
        item = _Item(described, self._local(path))
        if described.kind == "message":
            self._parts[-1].listed = item
            self._parts.append(_Part())
            return
        if described.array and not item.is_text:
            kind = f"dtype_{item.value}"
            self.names[kind] = np.dtype(described.type).newbyteorder("<")
            self._lines += (
                f"if type({item.value}) is not ndarray or {item.value}.dtype != {kind}:",
                f"    {item.value} = asarray({item.value}, dtype={kind})",
            )
        self._parts[-1].items.append(item)

    def _expression(self, path: str) -> str:
        """Expression for a value, whose parent is a local variable."""
        above, _, own = path.rpartition(".")
        return f"{self._local(above)}.{own}"

    def _local(self, path: str) -> str:
        """The local variable with a value; created if it does not exist."""
        if path not in self._read:
            expression = self._expression(path)
            self._read[path] = name = f"v{len(self._read)}"
            self._lines.append(f"{name} = {expression}")
        return self._read[path]

    def _pack(self, number: int, part: _Part, writer_of: Callable[[str], Writer]) -> None:
        items, listed = list(part.items), part.listed
        if listed is not None:
            count, described = f"count{number}", f"field{number}"
            self._lines.append(f"{count} = len({listed.value})")
            if listed.field.length is not None or listed.field.most:
                self.names |= {described: listed.field, "check_count": check_count}
                self._lines.append(f"check_count({described}, {count})")
            if listed.field.length is None:
                items.append(_Item(listed.field, count, "I"))
        if items:
            self._pack_items(number, items)
        if listed is not None:
            write = f"write{number}"
            self.names[write] = writer_of(listed.field.type)
            self._lines += (f"for each in {listed.value}:", f"    at = {write}(each, parts, at)")

    def _pack_items(self, number: int, items: Sequence[_Item]) -> None:
        groups = list(_grouped(items))
        layouts, known, make = _Layouts(groups), f"known{number}", f"make{number}"
        self.names |= {known: layouts.known, make: layouts.make}
        key = ", ".join(("at & 7", *(_length(item) for item in items if not item.code)))
        unpacked, arguments = ["pack", "size"], []
        for index, group in enumerate(groups):
            if _has_constant(group):
                unpacked.append(f"k{index}")
                arguments.append(f"k{index}")
            last = group[-1]
            if last.code:
                arguments += [last.value] if last.value else []
            elif not last.is_text:
                arguments.append(f"{last.value}.tobytes()")
        self._lines += (
            f"key = {key}",
            f"layout = {known}.get(key)",
            "if layout is None:",
            f"    layout = {make}(key)",
            "    if layout is None:",
            "        del parts[mark:]",
            f"        return others({_FIRST}, parts, start)",
            f"{', '.join(unpacked)} = layout",
            f"parts.append(pack({', '.join(arguments)}))",
            "at += size",
        )


def _length(item: _Item) -> str:
    """Expression for what the layout of a string or an array depends on."""
    if not item.field.array:
        return item.value
    return f"tuple({item.value})" if item.is_text else f"{item.value}.size"


def _grouped(items: Sequence[_Item]) -> Iterator[list[_Item]]:
    """Splits fields into numbers, and strings with the array that follows them."""
    group: list[_Item] = []
    for item in items:
        if item.code and group:
            yield group
            group = []
        group.append(item)
        if not item.is_text:
            yield group
            group = []
    if group:
        yield group


def _has_constant(group: Sequence[_Item]) -> bool:
    """Whether a group begins with bytes that depend only on the layout."""
    first = group[0]
    return not first.code and (first.is_text or first.field.length is None)


class _Layouts:
    """Layouts of a part, by its offset, its strings, and the lengths of its arrays."""

    def __init__(self, groups: Sequence[Sequence[_Item]]) -> None:
        self._groups = groups
        self.known: dict[Any, Any] = {}

    def make(self, key: Any) -> Any:
        """Creates the layout for a key: the function that packs, the size, and constant bytes.

        Returns None for long strings and large arrays.

        Raises:
            ValueError: An array does not have the number of elements that its type needs.
        """
        start, *lengths = key if isinstance(key, tuple) else (key,)
        if not all(map(_is_short, lengths)):
            return None
        left = iter(lengths)
        form, at, constants = "<", start, []
        for group in self._groups:
            constant = b""
            for item in group:
                if item.code:
                    size = struct.calcsize(f"<{item.code}")
                    form += f"{-at % size}x{item.code}"
                    at += -at % size + size
                    continue
                length = next(left)
                if item.is_text:
                    constant += _texts(item.field, length, at + len(constant))
                    continue
                constant += _count(item.field, length, at + len(constant))
            if not group[-1].code:
                if _has_constant(group):
                    constants.append(constant)
                    form += f"{len(constant)}s"
                at += len(constant)
                if not group[-1].is_text:
                    size = np.dtype(group[-1].field.type).itemsize
                    gap = -at % size if length else 0
                    form += f"{gap}x{length * size}s"
                    at += gap + length * size
        layout = (struct.Struct(form).pack, at - start, *constants)
        if len(self.known) >= _KEPT:
            self.known.clear()
        self.known[key] = layout
        return layout


def _is_short(length: Any) -> bool:
    if isinstance(length, int):
        return length < _SMALL
    if isinstance(length, tuple):
        return len(length) <= _SHORT and all(map(_is_short, length))
    return len(length) <= _SHORT


def _texts(described: Field, value: Any, at: int) -> bytes:
    if not described.array:
        return _text(value, at)
    made = _count(described, len(value), at)
    for text in value:
        made += _text(text, at + len(made))
    return made


def _text(text: str, at: int) -> bytes:
    data = text.encode()
    return b"%b%b%b\0" % (bytes(-at % 4), struct.pack("<I", len(data) + 1), data)


def _count(described: Field, count: int, at: int) -> bytes:
    """The number of elements with its padding, or nothing if the type states it."""
    check_count(described, count)
    return bytes(-at % 4) + struct.pack("<I", count) if described.length is None else b""


def check_count(described: Field, count: int) -> None:
    """Refuses a number of elements that the type does not allow.

    Raises:
        ValueError: See above.
    """
    if described.length is None:
        if described.most and count > described.most:
            raise ValueError(f"{described.name} has at most {described.most} values (got {count})")
    elif count != described.length:
        raise ValueError(f"{described.name} must have {described.length} values (got {count})")
