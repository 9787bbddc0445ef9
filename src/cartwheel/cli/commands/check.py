"""Prints findings in the style of a compiler or for other programs."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

from cartwheel.checks import Result
from cartwheel.checks.checking import REPORTED
from cartwheel.checks.project import baseline, fixing, run
from cartwheel.cli.commands.check_formats import FORMATS
from cartwheel.cli.console import note, paint, say, table
from cartwheel.cli.showing import STYLES, quiet, shown
from cartwheel.cli.writing import writing
from cartwheel.errors import Diagnostic


def list_codes() -> None:
    """Prints the codes that a check can report, each with its severity and summary."""
    say(table((code.number, code.name, code.severity, code.summary) for code in REPORTED))


def check(
    path: str,
    values: Mapping[str, str],
    package_path: Sequence[Path],
    *,
    select: Sequence[str] = (),
    ignore: Sequence[str] = (),
    format: str = "text",
    strict: bool = False,
    controllers: Sequence[Path] = (),
    plugins: Sequence[Path] = (),
    accepted: Path | None = None,
    write_baseline: Path | None = None,
    fix: bool = False,
    diff: bool = False,
) -> int:
    """Prints the findings; returns the status: 1 for findings, 2 where much could not be read.

    Args:
        path: A description or a folder.
        values: Of the xacro's arguments.
        package_path: Where packages are looked for first.
        select: Codes to report.
        ignore: Codes not to report.
        format: ``text`` or one of `FORMATS`.
        strict: Whether notes count as findings.
        controllers: Files of controllers, in place of those that lie near the robot.
        plugins: Python files with plugins, which are executed.
        accepted: The baseline.
        write_baseline: Where to write a baseline of all findings instead of printing them.
        fix: Whether to write the fixes that are beyond doubt.
        diff: Whether to only print them.
    """

    def checked() -> Result:
        return run.check(
            path,
            arguments=values,
            package_path=package_path,
            controllers=controllers,
            select=select,
            ignore=ignore,
            baseline=accepted,
            use_baseline=write_baseline is None,
            plugins=plugins,
        )

    result = checked()
    if fix or diff:
        fixes = fixing.fixes(result.findings, fixing.project_of(Path(path)))
        count = sum(len(each.findings) for each in fixes)
        for each in fixes:
            (say if format == "text" else note)(each.diff)
        if diff and not fix:
            say(f"{_findings(count)} can be fixed")
            return int(bool(fixes))
        for each in fixes:
            with writing(each.file):
                each.write()
        note(f"fixed {_findings(count)}")
        result = checked()
    if write_baseline is not None:
        with writing(write_baseline):
            count = baseline.write(write_baseline, result.findings)
        say(f"wrote {_findings(count)} to {write_baseline}")
        return 0
    if format == "text":
        for finding, others in _alike(result.findings):
            say(shown(finding, others) + "\n")
        say(_summary(result))
    else:
        text = FORMATS[format](result)
        if text:
            say(text)
    if format in ("github", "junit", "sarif"):
        # CI logs also need the summary.
        sys.stdout.flush()
        note(_summary(result))
    if not result.complete:
        return 2
    counted = ("error", "warning", "info") if strict or result.strict else ("error", "warning")
    return int(any(result.count(severity) for severity in counted))


def _findings(count: int) -> str:
    return f"{count} finding{'s' if count != 1 else ''}"


def _alike(findings: Sequence[Diagnostic]) -> list[tuple[Diagnostic, list[Diagnostic]]]:
    """Each finding with those that say the same of other lines, which are shown together.

    Only findings without replacement text are combined, because the text belongs to its line.
    """
    groups: dict[tuple[object, ...], tuple[Diagnostic, list[Diagnostic]]] = {}
    for finding in findings:
        origin = finding.origin
        place = origin and (origin.file, origin.stack)
        same = (*finding.kind, finding.sorted_values, place)
        key = (id(finding),) if finding.instead or finding.also else same
        if key in groups:
            groups[key][1].append(finding)
        else:
            groups[key] = (finding, [])
    return list(groups.values())


def _summary(result: Result) -> str:
    counts = [
        f"{count} {name}{'s' if count != 1 else ''}"
        for name, severity in (("error", "error"), ("warning", "warning"), ("note", "info"))
        if (count := result.count(severity))
    ]
    text = ", ".join(counts) if counts else "no problems found"
    for count, word in (
        (result.ignored, "ignored"),
        (result.suppressed, "suppressed"),
        (result.accepted, "in the baseline"),
    ):
        if count:
            text += f", {count} {word}"
    if not result.complete:
        text += "; the check is incomplete"
    worst = next((s for s in ("error", "warning", "info") if result.count(s)), None)
    styles = STYLES[worst] if worst is not None else ("green", "bold")
    reports = result.reports
    subject = reports[0].file if len(reports) == 1 else f"{result.path} ({len(reports)} robots)"
    return quiet(f"{subject}: {paint(text, *styles)}")
