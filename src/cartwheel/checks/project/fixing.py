"""Applies suggested fixes to files where the fix is certain.

Fixable are misspelt tags, degrees, inertias computed from a link's geometry, and wheel sizes, if
the element is written literally in the file: not in a macro, and without an expression.
"""

from __future__ import annotations

import difflib
import os
import re
import tempfile
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from xml.parsers import expat

from cartwheel.codes import devices, robot, tags
from cartwheel.errors import Diagnostic

FIXABLE = frozenset({
    tags.TAG_IGNORED, devices.PLUGIN_PARAMETER_UNKNOWN, robot.LIMIT_IN_DEGREES,
    robot.ANGLE_IN_DEGREES, robot.INERTIA_IMPOSSIBLE, robot.INERTIA_GEOMETRY_MISMATCH,
    robot.WHEEL_SEPARATION_MISMATCH, robot.WHEEL_DIAMETER_MISMATCH, tags.LINK_CUT_SHORT,
})  # fmt: skip
"""The codes with fixable suggestions."""
_MISSPELT = (tags.TAG_IGNORED, devices.PLUGIN_PARAMETER_UNKNOWN)
_ATTRIBUTE = re.compile(rb"([\w:.-]+)\s*=\s*(\"[^\"]*\"|'[^']*')")
_START = re.compile(rb"<([\w:.-]+)((?:\s+[\w:.-]+\s*=\s*(?:\"[^\"]*\"|'[^']*'))*)\s*(/?)>")
_MAX_BYTES = 50_000_000


@dataclass(frozen=True, kw_only=True, slots=True)
class Fix:
    """A file with its fixes."""

    file: Path
    before: bytes
    after: bytes
    findings: tuple[Diagnostic, ...]
    """The findings that it fixes."""

    @property
    def diff(self) -> str:
        """The changes as a unified diff."""
        old, new = (
            content.decode("utf-8").splitlines(keepends=True)
            for content in (self.before, self.after)
        )
        name = self.file.as_posix()
        return "".join(difflib.unified_diff(old, new, f"a/{name}", f"b/{name}"))

    def write(self) -> None:
        """Replaces the file atomically."""
        target = self.file.resolve()
        descriptor, name = tempfile.mkstemp(dir=target.parent, prefix=f".{target.name}.")
        try:
            with os.fdopen(descriptor, "wb") as stream:
                stream.write(self.after)
            Path(name).chmod(target.stat().st_mode)
            Path(name).replace(target)
        except BaseException:
            Path(name).unlink(missing_ok=True)
            raise


def fixes(findings: Iterable[Diagnostic], root: Path) -> list[Fix]:
    """The fixes for all fixable findings, one per file.

    Args:
        findings: Findings of a check.
        root: Only files in this folder are fixed, because a description may include any file.
    """
    by_file: dict[str, list[Diagnostic]] = {}
    for finding in findings:
        if finding.origin is not None and _may_be_fixed(finding):
            by_file.setdefault(finding.origin.file, []).append(finding)
    made = (_fix(Path(file), ours, root) for file, ours in by_file.items())
    return [fix for fix in made if fix is not None]


def project_of(path: Path) -> Path:
    """The folder with fixable files: the given folder, a file's package, or the file's folder."""
    start = path.absolute()
    if start.is_dir():
        return start
    packages = (each for each in start.parents if (each / "package.xml").is_file())
    return next(packages, start.parent)


def _may_be_fixed(finding: Diagnostic) -> bool:
    return (
        finding.code in FIXABLE
        and bool(finding.instead)
        and finding.place in ("element", "attribute", "line")
        and not finding.also
        and finding.origin is not None
        and not finding.origin.stack
    )


def _fix(file: Path, findings: list[Diagnostic], root: Path) -> Fix | None:
    if not file.resolve().is_relative_to(root.resolve()) or not file.is_file():
        return None
    if file.stat().st_size > _MAX_BYTES:
        return None
    before = file.read_bytes()
    try:
        before.decode("utf-8")
    except UnicodeDecodeError:
        return None
    edits: list[tuple[int, int, bytes]] = []
    fixed: list[Diagnostic] = []
    starts: dict[int, list[int]] | None = None
    for finding in findings:
        if finding.place == "line":
            own = _line_edits(before, finding)
        else:
            starts = _element_starts(before) if starts is None else starts
            own = _element_edits(before, finding, starts)
        overlap = any(a < end and start < b for a, b, _ in own for start, end, _ in edits)
        if own and not overlap:
            edits += own
            fixed.append(finding)
    if not fixed:
        return None
    after = before
    for start, end, text in sorted(edits, reverse=True):
        after = after[:start] + text + after[end:]
    return Fix(file=file, before=before, after=after, findings=tuple(fixed))


def _element_starts(content: bytes) -> dict[int, list[int]]:
    """Byte offsets of the elements on each line."""
    starts: dict[int, list[int]] = {}
    parser = expat.ParserCreate()

    def begin(_tag: str, _attributes: Mapping[str, str]) -> None:
        starts.setdefault(parser.CurrentLineNumber, []).append(parser.CurrentByteIndex)

    parser.StartElementHandler = begin
    try:
        parser.Parse(content, True)
    except expat.ExpatError:
        return {}
    return starts


def _element_edits(
    content: bytes, finding: Diagnostic, starts: Mapping[int, list[int]]
) -> list[tuple[int, int, bytes]]:
    assert finding.origin is not None
    candidates = [
        edits
        for start in starts.get(finding.origin.line, ())
        if (match := _START.match(content, start)) is not None
        and (edits := _edits(content, match, finding))
    ]
    # With several elements on one line, it is unclear which one is meant.
    return candidates[0] if len(candidates) == 1 else []


def _edits(
    content: bytes, source: re.Match[bytes], finding: Diagnostic
) -> list[tuple[int, int, bytes]]:
    new = finding.instead.encode()
    if finding.place == "attribute":
        stated = _ATTRIBUTE.fullmatch(new)
        return [] if stated is None else _attribute_edits(source, {stated[1]: stated[2][1:-1]})
    wanted = _START.match(new)
    if wanted is None or b"$" in source[0]:
        return []
    text = content[source.end() : content.find(b"<", source.end())] if not source[3] else b""
    closing = re.compile(rb"</(" + re.escape(source[1]) + rb")\s*>").match(
        content, source.end() + len(text)
    )
    if b"$" in text or (not source[3] and closing is None):
        return []  # an expression, or an element with children or comments
    new_text = new[wanted.end() : new.find(b"<", wanted.end())] if not wanted[3] else b""
    if finding.code in _MISSPELT:
        same = _attributes(source) == _attributes(wanted) and text.strip() == new_text.strip()
        if not same or source[1] == wanted[1]:
            return []
        ends = [source.span(1)] + ([closing.span(1)] if closing is not None else [])
        return [(start, end, wanted[1]) for start, end in ends]
    if source[1] != wanted[1]:
        return []
    edits = _attribute_edits(source, _attributes(wanted), required=False)
    if text.strip() != new_text.strip():
        begin = source.end() + len(text) - len(text.lstrip())
        edits.append((begin, begin + len(text.strip()), new_text))
    return edits


def _attributes(tag: re.Match[bytes]) -> dict[bytes, bytes]:
    return {each[1]: each[2][1:-1] for each in _ATTRIBUTE.finditer(tag[2])}


def _attribute_edits(
    source: re.Match[bytes], values: Mapping[bytes, bytes], *, required: bool = True
) -> list[tuple[int, int, bytes]]:
    """Edits only the values that differ, so that the rest of the tag is unchanged."""
    if b"$" in source[2]:
        return []
    written = {each[1]: each for each in _ATTRIBUTE.finditer(source[2])}
    if required and not values.keys() <= written.keys():
        return []
    edits = []
    added = b""
    for name, value in values.items():
        if name not in written:
            added += b" " + name + b'="' + value + b'"'
        elif written[name][2][1:-1] != value:
            start, end = (source.start(2) + index for index in written[name].span(2))
            edits.append((start + 1, end - 1, value))
    if added:
        edits.append((source.end(2), source.end(2), added))
    return edits


def _line_edits(content: bytes, finding: Diagnostic) -> list[tuple[int, int, bytes]]:
    assert finding.origin is not None
    lines = content.splitlines(keepends=True)
    number = finding.origin.line
    if not 1 <= number <= len(lines) or b"$" in lines[number - 1]:
        return []
    line = lines[number - 1]
    start = sum(map(len, lines[: number - 1])) + len(line) - len(line.lstrip())
    return [(start, start + len(line.strip()), finding.instead.encode())]
