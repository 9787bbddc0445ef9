"""Generated functions that pack messages as CDR: one `struct` call for each part without lists.

The layout of a part depends on its offset and on the lengths of its strings and arrays. Messages of
one topic rarely differ in these, so the layouts and the bytes of strings are cached.
"""

from __future__ import annotations

import keyword
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from cartwheel.messages.cdr.layouts import (
    HEAD,
    Item,
    Layouts,
    check_count,
    grouped,
    has_constant,
    length_of,
)
from cartwheel.messages.field import CODES, Field

Writer = Callable[[Any, list[Any], int], int]
"""Writes a message at an offset: appends its parts to a list, and returns the offset after it."""
Encoder = Callable[[Any], bytes]
"""Returns the bytes of a message, with the encapsulation header."""

_FIRST = "m"
"""Name of the message in the generated code."""


@dataclass(slots=True)
class _Part:
    """Successive fields that one call packs."""

    items: list[Item] = field(default_factory=list)
    listed: Item | None = None
    """The list of messages that follows the part."""


def compiled_writer(
    flat: Sequence[tuple[str, Field, str]], write_others: Writer, writer_of: Callable[[str], Writer]
) -> Writer:
    """Compiles the writer of a message type, for messages in other ones.

    Args:
        flat: Path, description and `struct` code of each field, in byte order.
        write_others: Writes messages with long strings or large arrays. Returned if a field is not
            supported.
        writer_of: Returns the writer of a nested type.
    """
    if not _are_supported(flat):
        return write_others
    write: Writer = _Source(flat, writer_of, whole=False).function(write_others)
    return write


def compiled_encoder(
    flat: Sequence[tuple[str, Field, str]], write_others: Writer, writer_of: Callable[[str], Writer]
) -> Encoder:
    """Compiles the encoder of a message type; see `compiled_writer`.

    It needs no list of parts, unless the message contains a list of messages.
    """
    encode_others = joined(write_others)
    if not _are_supported(flat):
        return encode_others
    encode: Encoder = _Source(flat, writer_of, whole=True).function(encode_others)
    return encode


def joined(write: Writer) -> Encoder:
    """Returns the encoder for the messages that a writer writes."""

    def encode(message: Any) -> bytes:
        parts: list[Any] = [HEAD]
        write(message, parts, 0)
        return b"".join(parts)

    return encode


def _are_supported(flat: Sequence[tuple[str, Field, str]]) -> bool:
    return all(_is_supported(path, described) for path, described, _ in flat)


def _is_supported(path: str, described: Field) -> bool:
    names = path.split(".")
    if described.wide or any(map(keyword.iskeyword, names)):
        return False
    if not all(map(str.isidentifier, names)):
        return False
    return described.kind in ("string", "message") or described.type in CODES


class _Source:
    """Source text of the writer or of the encoder of a message type.

    Args:
        flat: See `compiled_writer`.
        writer_of: See `compiled_writer`.
        whole: Whether the function is the encoder.
    """

    def __init__(
        self,
        flat: Sequence[tuple[str, Field, str]],
        writer_of: Callable[[str], Writer],
        *,
        whole: bool,
    ) -> None:
        self._names: dict[str, Any] = {
            "asarray": np.asarray,
            "check_count": check_count,
            "head": HEAD,
            "join": b"".join,
            "ndarray": np.ndarray,
        }
        """Global names of the text."""
        self._lines: list[str] = []
        self._read: dict[str, str] = {"": _FIRST}
        """Local variables, by the path of the value."""
        self._whole = whole
        self._parts = [_Part()]
        for path, described, code in flat:
            self._add(path, described, code)
        self._is_single = len(self._parts) == 1
        if not self._whole and not self._is_single:
            self._lines.insert(0, "start, mark = at, len(parts)")
        for number, part in enumerate(self._parts):
            if part.items or part.listed is not None:
                self._pack(number, part, writer_of)
        if not whole:
            self._lines.append("return at")
        elif not self._is_single:
            self._lines.append("return join(parts)")

    def function(self, others: Callable[..., Any]) -> Any:
        """The compiled function. It calls `others` for long strings and large arrays."""
        arguments = _FIRST if self._whole else f"{_FIRST}, parts, at"
        text = "\n    ".join((f"def write({arguments}):", *self._lines))
        names = self._names | {"others": others}
        exec(text, names)  # noqa: S102 - the names in it are identifiers
        return names["write"]

    def _add(self, path: str, described: Field, code: str) -> None:
        if code:
            value = "" if code == "x" else self._expression(path)
            self._parts[-1].items.append(Item(described, value, code))
            return
        item = Item(described, self._local(path))
        if described.kind == "message":
            self._parts[-1].listed = item
            self._parts.append(_Part())
            return
        if described.array and not item.is_text:
            self._read_array(item)
        self._parts[-1].items.append(item)

    def _read_array(self, item: Item) -> None:
        """Makes a local variable an array with the type of its field."""
        value, kind, same = item.value, f"dtype_{item.value}", f"same_{item.value}"
        own = np.dtype(item.field.type)
        self._names |= {kind: own.newbyteorder("<"), same: own}
        # numpy has one object for each type in the machine's byte order. Comparing it by identity
        # takes a third of the time.
        is_own = sys.byteorder == "little"
        if_other = f"{value}.dtype is not {same} and " if is_own else ""
        self._lines += (
            f"if {value}.__class__ is not ndarray or ({if_other}{value}.dtype != {kind}):",
            f"    {value} = asarray({value}, dtype={kind})",
        )
        if item.is_fixed:
            size, described = f"bytes_{value}", f"field_{value}"
            self._names[described] = item.field
            self._lines += (
                f"{size} = {value}.tobytes()",
                f"if len({size}) != {item.size}:",
                f"    check_count({described}, {value}.size)",
            )

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
                self._names[described] = listed.field
                self._lines.append(f"check_count({described}, {count})")
            if listed.field.length is None:
                items.append(Item(listed.field, count, "I"))
        is_first = self._whole and number == 0
        if items:
            self._pack_items(number, items, is_first=is_first)
        elif is_first:
            self._lines.append("parts, at = [head], 0")
        if listed is not None:
            write = f"write{number}"
            self._names[write] = writer_of(listed.field.type)
            self._lines += (f"for each in {listed.value}:", f"    at = {write}(each, parts, at)")

    def _pack_items(self, number: int, items: Sequence[Item], *, is_first: bool) -> None:
        """Packs a part. The offset of the first part of a whole message is always 0."""
        groups = list(grouped(items))
        values = [length_of(item) for item in items if not item.code and not item.is_fixed]
        keys = values if is_first else ["at & 7", *values]
        layouts = Layouts(groups, is_first=is_first, is_single=len(keys) == 1)
        pack, size = f"pack{number}", f"size{number}"
        unpacked, arguments = [pack, size], ["head"] if is_first else []
        for index, group in enumerate(groups):
            if has_constant(group):
                unpacked.append(f"text{number}_{index}")
                arguments.append(unpacked[-1])
            last = group[-1]
            if last.code:
                arguments += [last.value] if last.value else []
            elif last.is_fixed:
                arguments.append(f"bytes_{last.value}")
            elif not last.is_text:
                arguments.append(f"{last.value}.tobytes()")
        known, make, key = f"known{number}", f"make{number}", ", ".join(keys)
        self._names |= {known: layouts.known, make: layouts.make}
        if keys:
            self._lines += (
                "try:",
                f"    {', '.join(unpacked)} = {known}[{key}]",
                "except KeyError:",
                f"    layout = {make}({key})",
                "    if layout is None:",
                *(f"        {line}" for line in self._fallback()),
                f"    {', '.join(unpacked)} = layout",
            )
        else:
            # All messages have the same layout.
            self._names |= dict(zip(unpacked, layouts.make(), strict=True))
        packed = f"{pack}({', '.join(arguments)})"
        if is_first:
            self._lines.append(
                f"return {packed}" if self._is_single else f"parts, at = [{packed}], {size}"
            )
        else:
            self._lines += (f"parts.append({packed})", f"at += {size}")

    def _fallback(self) -> tuple[str, ...]:
        if self._whole:
            return (f"return others({_FIRST})",)
        if self._is_single:
            return (f"return others({_FIRST}, parts, at)",)
        return ("del parts[mark:]", f"return others({_FIRST}, parts, start)")
