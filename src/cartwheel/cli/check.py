"""``cartwheel check``: what is wrong with a description, where, and what to write instead."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from cartwheel.cli import arguments, help


def add_to(app: typer.Typer) -> None:
    """Adds the command."""
    help.add(app, check, group=help.FILES)


def check(
    words: arguments.Names = None,
    *,
    json: Annotated[
        bool,
        typer.Option("--json", help="Print the findings as JSON.", rich_help_panel=help.REPORT),
    ] = False,
    strict: Annotated[
        bool,
        typer.Option(
            "--strict", help="Exit with status 1 for notes too.", rich_help_panel=help.REPORT
        ),
    ] = False,
    ignore: Annotated[
        list[str] | None,
        typer.Option(
            "--ignore",
            metavar="RULE",
            help="Skip this rule. Can be repeated.",
            rich_help_panel=help.REPORT,
        ),
    ] = None,
    rules: Annotated[
        bool, typer.Option("--list", help="List all rules and exit.", rich_help_panel=help.REPORT)
    ] = False,
    package_path: arguments.PackagePath = None,
    controllers: Annotated[
        list[Path] | None,
        typer.Option(
            "--controllers",
            metavar="FILE",
            help="Also check this ros_control or ros2_control YAML file. Can be repeated.",
            rich_help_panel=help.LOOKUP,
        ),
    ] = None,
) -> None:
    """Find mistakes in a robot description, with suggested fixes.

    Exits with status 0 if there are no errors or warnings (with --strict: no notes either), 1 if
    there are, and 2 if the file cannot be read or is not a robot description.
    """
    from cartwheel.cli.commands import check as work

    if rules:
        work.list_codes()
        return
    file, values = arguments.split(words)
    status = work.check(
        arguments.needed(file),
        values,
        package_path or [],
        ignore=ignore or [],
        json=json,
        strict=strict,
        controllers=controllers or [],
    )
    if status:
        raise typer.Exit(status)
