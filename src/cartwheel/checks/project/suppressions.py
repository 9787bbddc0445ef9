"""Comments that suppress a code at one location.

``<!-- cartwheel: ignore CW204 -->`` in XML and ``# cartwheel: ignore CW204`` in YAML, on the
element's line or the line above. Separate several codes by commas or spaces; a reason may follow in
parentheses.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from cartwheel.codes import codes_matching, command
from cartwheel.description.elements import xml
from cartwheel.description.files.regular_files import read_regular_text
from cartwheel.errors import Code, Diagnostic, Origin, UnknownNameError

_IN_XML = re.compile(r"<!--\s*cartwheel:\s*ignore\b")
_END = "-->"
_IN_YAML = re.compile(r"#\s*cartwheel:\s*ignore\b([^(\n]*)")
_YAML = (".yaml", ".yml")
MOST = 1000
"""Maximum suppressions per file; later ones are not read."""


@dataclass
class Suppression:
    """A comment, and whether it has suppressed a finding."""

    file: str
    line: int
    lines: frozenset[int]
    """Lines whose findings it suppresses."""
    word: str
    codes: frozenset[Code]
    hint: str = ""
    used: bool = field(default=False)


class Suppressions:
    """The suppressions in the files of one or several checks."""

    def __init__(self) -> None:
        self._by_file: dict[str, list[Suppression]] = {}

    def suppresses(self, finding: Diagnostic) -> bool:
        """Whether a comment suppresses a finding; that comment then counts as used."""
        if finding.origin is None or not finding.origin.line:
            return False
        suppressed = False
        for each in self._of(finding.origin.file):
            if finding.origin.line in each.lines and finding.code in each.codes:
                each.used = suppressed = True
        return suppressed

    def unused(self, files: Iterable[str]) -> list[Diagnostic]:
        """A note for each comment in these files that has suppressed nothing."""
        return [
            command.SUPPRESSION_UNUSED.diagnostic(
                f"no finding on this line has the code {each.word}"
                if each.codes
                else f'the code "{each.word}" does not exist',
                origin=Origin(file=each.file, line=each.line),
                hint=each.hint or "Remove the comment.",
                mark=each.word,
                values={"code": each.word},
            )
            for file in dict.fromkeys(files)
            for each in self._of(file)
            if not each.used
        ]

    def _of(self, file: str) -> list[Suppression]:
        if file not in self._by_file:
            self._by_file[file] = _read(file)
        return self._by_file[file]


def _read(file: str) -> list[Suppression]:
    try:
        lines = read_regular_text(Path(file), xml.MAX_BYTES).split("\n")
    except (OSError, ValueError):
        return []
    parted = _parted_yaml if file.endswith(_YAML) else _parted_xml
    found: list[Suppression] = []
    for number, line in enumerate(lines, 1):
        # A simple search first: most lines contain no suppression.
        if "cartwheel:" not in line:
            continue
        comments, others = parted(line)
        alone = not others.strip()
        reach = {number, _next(lines, number, parted)} if comments and alone else {number}
        for word in re.split(r"[\s,]+", " ".join(comments)):
            if len(found) >= MOST:
                return found
            if word:
                found.append(_suppression(file, number, frozenset(reach), word))
    return found


def _parted_xml(line: str) -> tuple[list[str], str]:
    """The codes in each comment on a line, and the rest of the line.

    The time is linear in the line's length, because the files may be untrusted.
    """
    comments, others, at = list[str](), list[str](), 0
    while (begin := _IN_XML.search(line, at)) is not None:
        end = line.find(_END, begin.end())
        if end < 0:
            break
        comments.append(line[begin.end() : end].partition("(")[0])
        others.append(line[at : begin.start()])
        at = end + len(_END)
    return comments, "".join((*others, line[at:]))


def _parted_yaml(line: str) -> tuple[list[str], str]:
    """The same as `_parted_xml` for YAML."""
    return _IN_YAML.findall(line), _IN_YAML.sub("", line)


def _next(lines: Sequence[str], number: int, parted: Callable[[str], tuple[list[str], str]]) -> int:
    """The first line after a comment that contains anything except comments."""
    for following in range(number, min(number + 20, len(lines))):
        if parted(lines[following])[1].strip():
            return following + 1
    return number


def _suppression(file: str, line: int, lines: frozenset[int], word: str) -> Suppression:
    try:
        return Suppression(file, line, lines, word, codes_matching(word))
    except UnknownNameError as error:
        return Suppression(file, line, lines, word, frozenset(), hint=error.hint or "")
