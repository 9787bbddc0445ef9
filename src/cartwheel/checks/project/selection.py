"""Selected and ignored codes, by number, name or prefix of a number."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass

from cartwheel.codes import all_codes, code_named
from cartwheel.errors import Code

_PREFIX = re.compile(r"CW\d{0,2}", re.IGNORECASE)


def codes_matching(text: str) -> frozenset[Code]:
    """The code with a number or name, or all codes with a prefix such as ``CW2``.

    Raises:
        UnknownNameError: No code matches.
    """
    word = text.strip()
    if _PREFIX.fullmatch(word):
        matching = frozenset(code for code in all_codes() if code.number.startswith(word.upper()))
        if matching:
            return matching
    return frozenset({code_named(word)})


@dataclass(frozen=True, kw_only=True, slots=True)
class Selection:
    """Codes to report; by default all codes."""

    select: frozenset[Code] | None = None
    """None for all codes."""
    ignore: frozenset[Code] = frozenset()

    @classmethod
    def of(cls, select: Iterable[str] = (), ignore: Iterable[str] = ()) -> Selection:
        """The selection in options or settings.

        Raises:
            UnknownNameError: A code does not exist.
        """
        chosen = [codes_matching(word) for word in select]
        return cls(
            select=frozenset().union(*chosen) if chosen else None,
            ignore=frozenset[Code]().union(*(codes_matching(word) for word in ignore)),
        )

    def __contains__(self, code: Code) -> bool:
        return (self.select is None or code in self.select) and code not in self.ignore
