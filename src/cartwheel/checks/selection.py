"""Which codes count: selected and ignored ones, by number, name or the begin of a number."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass

from cartwheel.codes import all_codes, code_named
from cartwheel.errors import Code

_PREFIX = re.compile(r"CW\d{0,2}", re.IGNORECASE)


def codes_matching(text: str) -> frozenset[Code]:
    """The code of a number or a name, or all codes whose number begins with ``CW2`` and the like.

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
    """Codes that are reported; by default all of them."""

    select: frozenset[Code] | None = None
    """None for all."""
    ignore: frozenset[Code] = frozenset()

    @classmethod
    def of(cls, select: Iterable[str] = (), ignore: Iterable[str] = ()) -> Selection:
        """The selection that options or settings state.

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
