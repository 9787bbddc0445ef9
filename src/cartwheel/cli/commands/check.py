"""Findings about a description, as a compiler shows them or as JSON."""

from __future__ import annotations

import json as json_module
import re
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from cartwheel.cli.console import paint, say, table
from cartwheel.description import xml
from cartwheel.description.check import RULES, Finding, PluginKnowledge, Report
from cartwheel.description.check import check as check_description
from cartwheel.description.model import PluginTag, Sensor
from cartwheel.description.regular import read_regular_text
from cartwheel.errors import DescriptionError, Diagnostic, PluginError

SCHEMA = 1
_STYLES = {"error": ("red", "bold"), "warning": ("yellow", "bold"), "info": ("cyan",)}
_WORDS = {"info": "note"}
_LINES_SHOWN = 10
_LOOK_AHEAD = 8
"""Lines of an element in which a caret's text is looked for."""


def list_rules() -> None:
    """Prints every rule with its severity and one line."""
    say(table((rule.name, rule.severity, rule.summary) for rule in RULES))


def check(
    file: str,
    values: Mapping[str, str],
    package_path: Sequence[Path],
    *,
    ignore: Sequence[str],
    json: bool,
    strict: bool,
    controllers: Sequence[Path] = (),
) -> int:
    """Prints what is found; returns the status: 1 for findings, 2 where much could not be read.

    Args:
        file: As for `cartwheel.description.load`.
        values: Of the xacro's arguments.
        package_path: Where packages are looked for first.
        ignore: Rules to leave out.
        json: Whether a program reads it.
        strict: Whether notes count as findings.
        controllers: Files of controllers, in place of those that lie near the robot.
    """
    try:
        report = check_description(
            file,
            arguments=values,
            package_path=package_path,
            known=knowledge(),
            ignore=ignore,
            controller_files=controllers,
        )
    except DescriptionError as error:
        if not json and (error.origin is None or not error.origin.line):
            raise  # there is no line to show
        report = _unread(file, error)
    if json:
        say(json_module.dumps(as_mapping(report), indent=2, ensure_ascii=False))
    else:
        for finding, others in _alike(report.findings):
            say(shown(finding, others))
        say(_summary(report))
    if not report.complete:
        return 2
    counted = ("error", "warning", "info") if strict else ("error", "warning")
    return int(any(report.count(severity) for severity in counted))


def knowledge() -> PluginKnowledge:
    """What Cartwheel's own plugins and controllers know."""
    from cartwheel.plugins.control.catalogue import controller_types
    from cartwheel.plugins.control.suggestion import files_for

    return PluginKnowledge(
        filenames=_filenames(),
        judge=_judge,
        controller_types=tuple(sorted(controller_types())),
        controller_files=files_for,
    )


def as_mapping(report: Report) -> dict[str, Any]:
    """The report in the form that docs/check.md promises."""
    return {
        "schema": SCHEMA,
        "file": report.file,
        "name": report.name,
        "complete": report.complete,
        "summary": {
            "error": report.count("error"),
            "warning": report.count("warning"),
            "info": report.count("info"),
            "ignored": report.ignored,
        },
        "findings": [_finding(finding) for finding in report.findings],
    }


def _unread(file: str, error: DescriptionError) -> Report:
    """What ends a check at once, as its one finding."""
    finding = Finding(
        rule="unreadable",
        severity="error",
        message=error.message,
        origin=error.origin,
        hint=error.hint or "",
    )
    return Report(file=file, name="", findings=(finding,), ignored=0, complete=False)


def _alike(findings: Sequence[Finding]) -> list[tuple[Finding, list[Finding]]]:
    """Each with those that say the very same of other lines, which are shown with it.

    Only what has no text to write is gathered: a text belongs to its line.
    """
    groups: dict[tuple[object, ...], tuple[Finding, list[Finding]]] = {}
    for finding in findings:
        origin = finding.origin
        same = (finding.rule, finding.message, finding.hint, origin and (origin.file, origin.stack))
        key = (id(finding),) if finding.instead or finding.also else same
        if key in groups:
            groups[key][1].append(finding)
        else:
            groups[key] = (finding, [])
    return list(groups.values())


def shown(finding: Finding, others: Sequence[Finding] = ()) -> str:
    """A finding with the line it is about, a caret under it, and the text to write.

    Args:
        finding: To be shown.
        others: That say the same of other lines of the same file.
    """
    styles = _STYLES[finding.severity]
    word = paint(f"{_WORDS.get(finding.severity, finding.severity)}:", *styles)
    place = paint(f"{finding.origin}: ", "bold") if finding.origin else ""
    lines = [f"{place}{word} {finding.message} {paint(f'[{finding.rule}]', 'dim')}"]
    lines += _excerpt(finding, styles)
    if finding.instead:
        lines.append(f"  {paint(_verb(finding), 'green')} {finding.instead}")
    if finding.hint:
        lines.append(f"  {finding.hint}")
    if finding.also:
        names = [match[1] for each in finding.also if (match := re.search(r'"([^"]*)"', each))]
        more = ", ".join(dict.fromkeys(names[:6])) + (", …" if len(names) > 6 else "")
        lines.append(f"  and {len(finding.also)} more from this line: {more}")
    if others:
        numbers = [str(one.origin.line) for one in others if one.origin is not None]
        more = ", …" if len(numbers) > _LINES_SHOWN else ""
        lines.append(f"  and {len(others)} more, in line {', '.join(numbers[:_LINES_SHOWN])}{more}")
    if finding.origin is not None:
        lines += [paint(f"  in {frame}", "dim") for frame in finding.origin.stack]
    return "\n".join(lines) + "\n"


def _verb(finding: Finding) -> str:
    return "add:" if finding.place in ("inside", "after") else "write:"


def _excerpt(finding: Finding, styles: tuple[str, ...]) -> list[str]:
    origin = finding.origin
    if origin is None or not origin.line:
        return []
    lines = _lines_of(origin.file)
    if origin.line > len(lines):
        return []
    number, column, width = _caret(lines, origin.line, finding.mark)
    # Tabs are one column wide here, as the caret's line cannot know the terminal's stops.
    source = lines[number - 1].replace("\t", " ")
    indent = len(source) - len(source.lstrip())
    label = f"{number:>5} | "
    under = " " * (len(label) + column - indent) + paint("^" + "~" * (width - 1), *styles)
    return [paint(label, "dim") + source[indent:].rstrip(), under]


def _lines_of(file: str) -> list[str]:
    try:
        return read_regular_text(Path(file), xml.MAX_BYTES).splitlines()
    except (OSError, ValueError):
        return []


def _caret(lines: Sequence[str], first: int, mark: str) -> tuple[int, int, int]:
    """Line, column from 0, and width of what a finding is about."""
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


def _summary(report: Report) -> str:
    counts = [
        f"{count} {name}{'s' if count != 1 else ''}"
        for name, severity in (("error", "error"), ("warning", "warning"), ("note", "info"))
        if (count := report.count(severity))
    ]
    text = ", ".join(counts) if counts else "nothing found"
    if report.ignored:
        text += f", {report.ignored} ignored"
    if not report.complete:
        text += "; not everything could be checked"
    worst = next((s for s in ("error", "warning", "info") if report.count(s)), None)
    styles = _STYLES[worst] if worst is not None else ("green", "bold")
    return f"{report.file}: {paint(text, *styles)}"


def _finding(finding: Finding) -> dict[str, Any]:
    origin = finding.origin
    column = 0
    line = origin.line if origin is not None else 0
    if origin is not None and origin.line:
        lines = _lines_of(origin.file)
        if origin.line <= len(lines):
            _, column, _ = _caret(lines, origin.line, finding.mark)
            column += 1
    return {
        "rule": finding.rule,
        "severity": finding.severity,
        "message": finding.message,
        "file": origin.file if origin is not None else "",
        "line": line,
        "column": column,
        "stack": list(origin.stack) if origin is not None else [],
        "instead": finding.instead,
        "place": finding.place,
        "hint": finding.hint,
        "also": list(finding.also),
    }


def _filenames() -> tuple[str, ...]:
    from cartwheel.plugins.catalogue import all_plugins

    return tuple(sorted({name for plugin in all_plugins() for name in plugin.filenames}))


def _judge(tag: PluginTag, _sensor: Sensor | None) -> Iterable[Diagnostic] | None:
    from cartwheel.plugins.catalogue import plugin_named, short_name
    from cartwheel.plugins.parameters import read
    from cartwheel.plugins.world_plugins import BUILT_IN

    plugin = plugin_named(tag.filename)
    if plugin is None:
        return () if short_name(tag.filename) in BUILT_IN else None
    try:
        _, diagnostics = read(plugin.parameters, tag.element)
    except PluginError as error:
        return [Diagnostic(severity="error", message=error.message, origin=error.origin)]
    return diagnostics
