"""Formats a diagnostic for the terminal: source line with a caret, fix and code."""

from __future__ import annotations

import re
import sys
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from typing import TextIO

from cartwheel.cli.console import note, paint
from cartwheel.errors import UNCLASSIFIED, Diagnostic

STYLES = {"error": ("red", "bold"), "warning": ("yellow", "bold"), "info": ("cyan",)}
"""The colours of each severity."""
_WORDS = {"info": "note"}
_LINES_SHOWN = 10
_NAMES_SHOWN = 6
_LONGEST = 200
"""Maximum characters of a line to show."""
_LOOK_AHEAD = 8
"""Lines of an element to search for the marked text."""


def shown(
    diagnostic: Diagnostic, others: Sequence[Diagnostic] = (), *, stream: TextIO | None = None
) -> str:
    """A diagnostic with its source line, a caret, and the replacement text.

    Args:
        diagnostic: The diagnostic.
        others: Diagnostics with the same message for other lines in the file.
        stream: Output stream, stdout by default. Only terminals get colours.
    """
    out = stream or sys.stdout
    styles = STYLES[diagnostic.severity]
    word = paint(f"{_WORDS.get(diagnostic.severity, diagnostic.severity)}:", *styles, stream=out)
    place = paint(f"{diagnostic.origin}: ", "bold", stream=out) if diagnostic.origin else ""
    code = paint(f" [{_code(diagnostic)}]", "dim", stream=out) if _code(diagnostic) else ""
    lines = [f"{place}{word} {diagnostic.message}{code}"]
    lines += _excerpt(diagnostic, styles, out)
    if diagnostic.instead:
        verb = "add:" if diagnostic.place in ("inside", "after") else "fix:"
        lines.append(f"  {paint(verb, 'green', stream=out)} {diagnostic.instead}")
    if diagnostic.hint:
        lines.append(f"  {diagnostic.hint}")
    if diagnostic.also:
        names = list(
            dict.fromkeys(filter(None, (difference(each, diagnostic) for each in diagnostic.also)))
        )
        more = ", ".join(names[:_NAMES_SHOWN]) + (", …" if len(names) > _NAMES_SHOWN else "")
        lines.append(
            f"  and {len(diagnostic.also)} more from this line{f': {more}' if more else ''}"
        )
    if others:
        numbers = [str(one.origin.line) for one in others if one.origin is not None]
        more = ", …" if len(numbers) > _LINES_SHOWN else ""
        word = "line" if len(numbers) == 1 else "lines"
        lines.append(
            f"  and {len(others)} more, on {word} {', '.join(numbers[:_LINES_SHOWN])}{more}"
        )
    if diagnostic.origin is not None:
        lines += [paint(f"  in {frame}", "dim", stream=out) for frame in diagnostic.origin.stack]
    return quiet("\n".join(lines))


def quiet(text: str) -> str:
    """A text without lines that GitHub treats as commands: it may contain untrusted names."""
    return re.sub(r"\n(?=\s*::)", r"\\n", text)


def print_diagnostic(diagnostic: Diagnostic) -> None:
    """Prints a diagnostic to stderr, after flushing stdout."""
    sys.stdout.flush()
    note(shown(diagnostic, stream=sys.stderr))


def difference(diagnostic: Diagnostic, other: Diagnostic) -> str:
    """The first name in its values that differs from a different diagnostic of its kind."""
    pairs = ((value, other.values.get(key)) for key, value in diagnostic.values.items())
    return next((one for one, its in pairs if isinstance(one, str) and one != its), "")


def column_of(diagnostic: Diagnostic) -> int:
    """The column of the diagnostic's subject, from 1; 0 if unknown."""
    origin = diagnostic.origin
    if origin is None or not origin.line:
        return 0
    lines = _lines_of(origin.file)
    return _caret(lines, origin.line, diagnostic.mark)[1] + 1 if origin.line <= len(lines) else 0


def _code(diagnostic: Diagnostic) -> str:
    return "" if diagnostic.code is UNCLASSIFIED else str(diagnostic.code)


def _excerpt(diagnostic: Diagnostic, styles: tuple[str, ...], out: TextIO) -> list[str]:
    origin = diagnostic.origin
    if origin is None or not origin.line:
        return []
    lines = _lines_of(origin.file)
    if origin.line > len(lines):
        return []
    number, column, width = _caret(lines, origin.line, diagnostic.mark)
    # Tabs are shown one column wide, because the terminal's tab stops are unknown.
    source = lines[number - 1].replace("\t", " ")
    indent = len(source) - len(source.lstrip())
    if len(source) - indent > _LONGEST:
        # For a file on a single line, show the part around the mark.
        indent = max(indent, column - _LONGEST // 4)
        source = source[: indent + _LONGEST]
        width = max(1, min(width, len(source) - column))
    label = f"{number:>5} | "
    under = " " * (len(label) + column - indent)
    return [
        paint(label, "dim", stream=out) + source[indent:].rstrip(),
        under + paint("^" + "~" * (width - 1), *styles, stream=out),
    ]


def _lines_of(file: str) -> Sequence[str]:
    try:
        state = Path(file).stat()
    except (OSError, ValueError):
        return ()
    return _lines_of_state(file, state.st_mtime_ns, state.st_size)


@lru_cache(maxsize=4)
def _lines_of_state(file: str, _changed_ns: int, _size: int) -> Sequence[str]:
    """The lines as counted by the XML parser; cached, because a file may have many findings."""
    from cartwheel.description.elements import xml
    from cartwheel.description.files.regular_files import read_regular_text

    try:
        return read_regular_text(Path(file), xml.MAX_BYTES).split("\n")
    except (OSError, ValueError):
        return ()


def _caret(lines: Sequence[str], first: int, mark: str) -> tuple[int, int, int]:
    """Line, column from 0, and width of a finding's subject."""
    if mark:
        pattern = rf"\b{re.escape(mark)}\s*=\s*(\"[^\"]*\"|'[^']*')" if mark.isidentifier() else ""
        for number in range(first, min(first + _LOOK_AHEAD, len(lines) + 1)):
            line = lines[number - 1]
            match = re.search(pattern, line) if pattern else None
            if match is not None:
                return number, match.start(), match.end() - match.start()
            if mark in line:
                return number, line.index(mark), len(mark)
            if ">" in line:
                break
    line = lines[first - 1]
    match = re.search(r"<[\w:.-]+[^>]*>?", line)
    if match is None:
        start = len(line) - len(line.lstrip())
        return first, start, max(1, len(line.strip()))
    return first, match.start(), match.end() - match.start()
