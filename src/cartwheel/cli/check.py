"""``cartwheel check``: mistakes in a description, with suggested fixes."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from cartwheel.cli import arguments, help


class Format(StrEnum):
    """Formats of a report."""

    text = "text"
    json = "json"
    sarif = "sarif"
    github = "github"
    junit = "junit"


def check(
    words: arguments.CheckNames = None,
    *,
    select: Annotated[
        list[str] | None,
        help.option(
            "--select CODES",
            "Report only these codes: a number (CW204), a name, or the beginning of a number "
            "(CW2). Separate several codes with commas.",
            help.REPORT,
        ),
    ] = None,
    ignore: Annotated[
        list[str] | None, help.option("--ignore CODES", "Do not report these codes.", help.REPORT)
    ] = None,
    format: Annotated[
        Format, help.option("--format", "Format of the report.", help.REPORT)
    ] = Format.text,
    json: Annotated[bool, help.option("--json", "Same as --format json.", help.REPORT)] = False,
    strict: Annotated[
        bool, help.option("--strict", "Also exit with status 1 if there are notes.", help.REPORT)
    ] = False,
    baseline: Annotated[
        Path | None,
        help.option(
            "--baseline FILE",
            "Report only findings that are not in this baseline file.",
            help.REPORT,
        ),
    ] = None,
    write_baseline: Annotated[
        Path | None,
        help.option(
            "--write-baseline FILE",
            "Write all findings to this baseline file and exit.",
            help.REPORT,
        ),
    ] = None,
    fix: Annotated[
        bool,
        help.option(
            "--fix",
            "Fix misspelt tags, angles in degrees, inertias and wheel sizes in the files.",
            help.REPORT,
        ),
    ] = False,
    diff: Annotated[
        bool, help.option("--diff", "Show what --fix would change, and exit.", help.REPORT)
    ] = False,
    codes: Annotated[bool, help.option("--list", "List all codes and exit.", help.REPORT)] = False,
    package_path: arguments.PackagePath = None,
    controllers: Annotated[
        list[Path] | None,
        help.option(
            "--controllers FILE",
            "Also check this ros_control or ros2_control YAML file. Can be repeated.",
            help.LOOKUP,
        ),
    ] = None,
    plugin: arguments.Plugin = None,
) -> None:
    """Find mistakes in robot descriptions, with suggested fixes.

    Exit status: 0 if there are no errors or warnings, 1 if there are any, 2 if the file cannot be
    read or is not a robot description.
    """
    from cartwheel.cli.commands import check as work

    if codes:
        work.list_codes()
        return
    file, values = arguments.split(words)
    status = work.check(
        arguments.needed(file),
        values,
        package_path or [],
        select=_words(select),
        ignore=_words(ignore),
        format="json" if json else format.value,
        strict=strict,
        controllers=controllers or [],
        plugins=plugin or [],
        accepted=baseline,
        write_baseline=write_baseline,
        fix=fix and not diff,
        diff=diff,
    )
    if status:
        raise typer.Exit(status)


def _words(options: list[str] | None) -> list[str]:
    return [word for text in options or () for word in text.split(",") if word.strip()]
