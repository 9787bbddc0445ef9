"""Findings about a description, as a compiler shows them or as JSON."""

from __future__ import annotations

import json as json_module
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from cartwheel.cli.console import paint, say, table
from cartwheel.cli.showing import STYLES, column_of, shown
from cartwheel.codes import files as files_codes
from cartwheel.description.check import REPORTED, PluginKnowledge, Report
from cartwheel.description.check import check as check_description
from cartwheel.description.model import PluginTag, Sensor
from cartwheel.errors import UNCLASSIFIED, DescriptionError, Diagnostic, PluginError

SCHEMA = 2


def list_codes() -> None:
    """Prints the codes that a check can report, each with its severity and one line."""
    say(table((code.number, code.name, code.severity, code.summary) for code in REPORTED))


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
            say(shown(finding, others) + "\n")
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
    finding = error.diagnostic()
    if finding.code is UNCLASSIFIED:
        finding = replace(finding, code=files_codes.UNREADABLE)
    return Report(file=file, name="", findings=(finding,), ignored=0, complete=False)


def _alike(findings: Sequence[Diagnostic]) -> list[tuple[Diagnostic, list[Diagnostic]]]:
    """Each with those that say the very same of other lines, which are shown with it.

    Only what has no text to write is gathered: a text belongs to its line.
    """
    groups: dict[tuple[object, ...], tuple[Diagnostic, list[Diagnostic]]] = {}
    for finding in findings:
        origin = finding.origin
        values = tuple(sorted(finding.values.items(), key=lambda item: item[0]))
        same = (*finding.kind, finding.message, values, origin and (origin.file, origin.stack))
        key = (id(finding),) if finding.instead or finding.also else same
        if key in groups:
            groups[key][1].append(finding)
        else:
            groups[key] = (finding, [])
    return list(groups.values())


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
    styles = STYLES[worst] if worst is not None else ("green", "bold")
    return f"{report.file}: {paint(text, *styles)}"


def _finding(finding: Diagnostic) -> dict[str, Any]:
    origin = finding.origin
    return {
        "code": finding.code.number,
        "name": finding.code.name,
        "rule": finding.code.name,
        "severity": finding.severity,
        "message": finding.message,
        "file": origin.file if origin is not None else "",
        "line": origin.line if origin is not None else 0,
        "column": column_of(finding),
        "stack": list(origin.stack) if origin is not None else [],
        "instead": finding.instead,
        "place": finding.place,
        "hint": finding.hint,
        "values": dict(finding.values),
        "also": [each.message for each in finding.also],
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
        return [error.diagnostic()]
    return diagnostics
