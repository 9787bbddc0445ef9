"""Limits on the resources of an expansion."""

from __future__ import annotations

import time
from typing import Any

from cartwheel.codes.files import EXPANSION_TOO_LARGE, EXPRESSION_INVALID
from cartwheel.errors import DescriptionError

MAX_CHARACTERS = 1_000_000
"""Maximum length of a string, and of all strings in one value."""
MAX_ITEMS = 100_000
"""Maximum items in a list, dict or range, including nested items."""
MAX_BITS = 4096
"""Maximum size of an integer."""
MAX_SECONDS = 10.0
"""CPU time of an expansion. The largest public robots take less than two seconds."""
MAX_OPERATIONS = 20_000_000
MAX_TOTAL = 100_000_000
"""Maximum characters created by an expansion; each may take four bytes."""
ITEM = 32
"""Memory of a list item in characters: its slot and a small value."""
_SMALL_BITS = 64

_LOOK = 1000
"""Operations between two looks at the clock, which costs as much as one operation."""


class ExpressionError(DescriptionError):
    """An expression that is not allowed, or a value that is too large."""

    code = EXPRESSION_INVALID


class TooLargeError(ExpressionError):
    """An expansion or a value that exceeds a limit.

    Args:
        message: One sentence.
        kind: What exceeds the limit, for programs.
        most: The limit.
    """

    code = EXPANSION_TOO_LARGE

    def __init__(self, message: str, kind: str, most: float) -> None:
        super().__init__(message, values={"kind": kind, "most": most})


class Budget:
    """The remaining resources of an expansion.

    Args:
        seconds: CPU time of the expanding thread; other programs do not reduce it.
    """

    def __init__(self, seconds: float = MAX_SECONDS) -> None:
        self.opaque: tuple[type, ...] = ()
        """Types that are not values."""
        self._seconds = seconds
        self._end = time.thread_time() + seconds
        self._operations = 0
        self._next_look = _LOOK
        self._total = 0

    def spend(self, operations: int = 1) -> None:
        """Counts operations.

        Raises:
            ExpressionError: There were too many, or they took too long.
        """
        self._operations += operations
        if self._operations >= self._next_look:
            self._next_look = self._operations + _LOOK
            self.look()

    def look(self) -> None:
        """Checks the CPU time.

        Raises:
            ExpressionError: As `spend`.
        """
        if self._operations > MAX_OPERATIONS:
            raise TooLargeError(
                f"the expressions of the xacro file require more than {MAX_OPERATIONS:,} "
                "operations",
                "operations",
                MAX_OPERATIONS,
            )
        if time.thread_time() > self._end:
            raise TooLargeError(
                f"the xacro file takes more than {self._seconds:g} s to expand",
                "time",
                self._seconds,
            )

    def make(self, size: int) -> None:
        """Counts characters that were created.

        Raises:
            ExpressionError: The total is too large.
        """
        self._total += size
        if self._total > MAX_TOTAL:
            raise TooLargeError(
                f"the xacro file expands to more than {MAX_TOTAL:,} characters", "memory", MAX_TOTAL
            )

    def text(self, length: int) -> None:
        """Counts a string before it is created.

        Raises:
            ExpressionError: The string is too long.
        """
        if length > MAX_CHARACTERS:
            raise TooLargeError(
                f"a text has more than {MAX_CHARACTERS:,} characters", "text", MAX_CHARACTERS
            )
        self.make(length)

    def items(self, count: int) -> None:
        """Counts the items of a list, dict or range before it is created.

        Raises:
            ExpressionError: There are too many items.
        """
        room(count)
        self.make(ITEM * count)

    def grow(self, count: int, more: int) -> None:
        """Counts items before they are added to a list, dict or set.

        Args:
            count: Current number of items.
            more: Number of additional items.

        Raises:
            ExpressionError: There are too many items.
        """
        room(count + more)
        self.make(ITEM * more)

    def result(self, value: Any) -> Any:
        """Counts the size of a new value, without nested values.

        Raises:
            ExpressionError: The value is too large.
        """
        kind = type(value)
        if kind is float or kind is bool:
            return value
        if kind is int:
            size = value.bit_length()
            if size > _SMALL_BITS:
                bits(size)
                self.make(size // 8)
        elif kind is str:
            self.text(len(value))
        elif isinstance(value, list | tuple | dict | set | frozenset | range):
            self.items(len(value))
        return value

    def weigh(self, value: Any) -> int:
        """Counts everything in a value; parts that occur several times count several times.

        A list that contains the same list a thousand times is small, but its text is not.

        Returns:
            The total number of characters in its strings.

        Raises:
            ExpressionError: The value is too large.
        """
        if isinstance(value, str):
            return len(value)
        if not isinstance(value, list | tuple | dict | set | frozenset):
            return 0
        count = characters = 0
        left: list[Any] = [value]
        while left:
            each = left.pop()
            if isinstance(each, str):
                characters += len(each)
                if characters > MAX_CHARACTERS:
                    raise TooLargeError(
                        f"a value has more than {MAX_CHARACTERS:,} characters",
                        "value",
                        MAX_CHARACTERS,
                    )
                continue
            if isinstance(each, self.opaque):
                raise ExpressionError(
                    "a xacro namespace cannot be used as a value", values={"refused": "namespace"}
                )
            if isinstance(each, dict):
                count += 2 * len(each)
            elif isinstance(each, list | tuple | set | frozenset):
                count += len(each)
            else:
                continue
            if count > MAX_ITEMS:
                raise TooLargeError(
                    f"a value has more than {MAX_ITEMS:,} items", "value", MAX_ITEMS
                )
            if isinstance(each, dict):
                left.extend(dict.keys(each))
                left.extend(dict.values(each))
            else:
                # Not a subclass's own iteration, which creates wrappers.
                left.extend(list.__iter__(each) if isinstance(each, list) else each)
        self.spend(count // 8)
        return characters


def room(count: int) -> None:
    """Rejects lists with too many items.

    Raises:
        ExpressionError: There are too many items.
    """
    if count > MAX_ITEMS:
        raise TooLargeError(f"a list has more than {MAX_ITEMS:,} items", "list", MAX_ITEMS)


def bits(count: int) -> None:
    """Rejects integers with too many bits before they are created.

    Raises:
        ExpressionError: There are too many bits.
    """
    if count > MAX_BITS:
        raise TooLargeError(f"a number has more than {MAX_BITS} bits", "number", MAX_BITS)
