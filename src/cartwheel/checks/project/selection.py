"""Selected and ignored codes."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from cartwheel.codes import codes_matching
from cartwheel.errors import Code


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
