"""Layouts of successive fields in CDR, for the generated functions."""

from __future__ import annotations

import struct
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from cartwheel.messages.field import Field

HEAD = b"\0\1\0\0"
"""Encapsulation header."""
_SHORT = 64
"""Maximum length in characters of a cached string, such as a frame name."""
_SMALL = 512
"""Number of elements from which an array is left to another writer, which does not copy it."""
_KEPT = 256
"""Maximum number of cached layouts of a part."""


@dataclass(frozen=True, slots=True)
class Item:
    """A field, and the expression that reads it in the generated code."""

    field: Field
    value: str
    code: str = ""
    """`struct` code of a number."""

    @property
    def is_text(self) -> bool:
        """Whether it is a string or a list of strings."""
        return self.field.kind == "string"

    @property
    def is_fixed(self) -> bool:
        """Whether it is a small array of numbers with fixed length."""
        field = self.field
        return not self.is_text and field.array and field.length in range(_SMALL)

    @property
    def count(self) -> int:
        """Number of elements of an array with fixed length."""
        return self.field.length or 0

    @property
    def size(self) -> int:
        """Size of an array of numbers with fixed length, in bytes."""
        return self.count * np.dtype(self.field.type).itemsize


def length_of(item: Item) -> str:
    """The expression for what the layout of a string or an array depends on."""
    if not item.field.array:
        return item.value
    return f"tuple({item.value})" if item.is_text else f"{item.value}.size"


def grouped(items: Sequence[Item]) -> Iterator[list[Item]]:
    """Splits fields into numbers, and strings with the array that follows them."""
    group: list[Item] = []
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


def has_constant(group: Sequence[Item]) -> bool:
    """Whether a group begins with bytes that depend only on the layout."""
    first = group[0]
    return not first.code and (first.is_text or first.field.length is None)


class Layouts:
    """Layouts of a part, by its offset, its strings, and the lengths of its arrays.

    Args:
        groups: The fields.
        is_first: Whether the part begins a whole message, with the encapsulation header. Its offset
            is not part of the key.
        is_single: Whether the key is a single value instead of a tuple.
    """

    def __init__(
        self, groups: Sequence[Sequence[Item]], *, is_first: bool, is_single: bool
    ) -> None:
        self._groups = groups
        self._is_first = is_first
        self._is_single = is_single
        self.known: dict[Any, Any] = {}

    def make(self, *key: Any) -> Any:
        """Creates the layout for a key: the function that packs, the size, and constant bytes.

        Returns None for long strings and large arrays.

        Raises:
            ValueError: An array does not have the number of elements that its type needs.
        """
        start, *lengths = (0, *key) if self._is_first else key
        if not all(map(_is_short, lengths)):
            return None
        left = iter(lengths)
        form, at, constants = f"<{len(HEAD)}s" if self._is_first else "<", start, []
        for group in self._groups:
            constant = b""
            for item in group:
                if item.code:
                    size = struct.calcsize(f"<{item.code}")
                    form += f"{-at % size}x{item.code}"
                    at += -at % size + size
                    continue
                length = item.count if item.is_fixed else next(left)
                if item.is_text:
                    constant += _texts(item.field, length, at + len(constant))
                    continue
                constant += _count(item.field, length, at + len(constant))
            if not group[-1].code:
                if has_constant(group):
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
        self.known[key[0] if self._is_single else key] = layout
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
