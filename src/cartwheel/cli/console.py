"""Output of commands: results on stdout, everything else on stderr; colours only on terminals."""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Iterable, Sequence
from typing import TextIO

_CODES = {"bold": "1", "dim": "2", "red": "31", "green": "32", "yellow": "33", "cyan": "36"}
_STYLES = "|".join(_CODES.values())
_OWN = rf"\x1b\[(?:0|(?:{_STYLES})(?:;(?:{_STYLES}))*)m"
_COMMANDS = re.compile(
    rf"({_OWN})|[\x00-\x08\x0b-\x1f\x7f-\x9f]"
    r"|[\u061c\u200e\u200f\u202a-\u202e\u2066-\u2069\ud800-\udfff]"
)
"""Characters that control a terminal, reverse the text direction, or cannot be encoded. Colours of
`paint` are kept.
"""


def is_terminal(stream: TextIO) -> bool:
    """Whether the stream supports colours."""
    return stream.isatty() and "NO_COLOR" not in os.environ and os.environ.get("TERM", "") != "dumb"


def paint(text: str, *styles: str, stream: TextIO | None = None) -> str:
    """The text in colour, if `stream` (stdout by default) supports it."""
    if not styles or not is_terminal(stream or sys.stdout):
        return text
    return f"\033[{';'.join(_CODES[style] for style in styles)}m{text}\033[0m"


def printable(text: str) -> str:
    """A text that is safe for a terminal: it may contain names and texts from untrusted sources.

    Unprintable characters are escaped with a backslash, as in Python.
    """
    return _COMMANDS.sub(lambda found: found[1] or found[0].encode("unicode_escape").decode(), text)


def say(text: str = "") -> None:
    """Prints a result line and flushes it, for readers of a pipe."""
    print(printable(text), flush=True)


def say_version() -> None:
    """Prints the version."""
    import cartwheel

    say(f"cartwheel {cartwheel.__version__}")


def note(text: str) -> None:
    """Prints a note about the result."""
    print(printable(text), file=sys.stderr, flush=True)


def say_table(rows: Sequence[Sequence[str]]) -> None:
    """Prints a `table` with a dim header."""
    head, *lines = table(rows).splitlines()
    say(paint(head, "dim"))
    for line in lines:
        say(line)


def table(rows: Iterable[Sequence[str]], *, indent: str = "") -> str:
    """Aligned columns; the last column may have any width."""
    kept = [list(row) for row in rows]
    if not kept:
        return ""
    widths = [max(len(row[i]) for row in kept) for i in range(len(kept[0]))]
    lines = (
        "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True))
        for row in kept
    )
    return "\n".join(f"{indent}{line}".rstrip() for line in lines)
