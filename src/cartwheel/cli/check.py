"""``cartwheel check``: what is wrong with a description, where, and what to write instead."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from cartwheel.cli import arguments


def add_to(app: typer.Typer) -> None:
    """Adds the command."""
    app.command()(check)


def check(
    words: arguments.Names = None,
    *,
    json: Annotated[
        bool, typer.Option("--json", help="Write the findings as JSON; docs/check.md has it.")
    ] = False,
    strict: Annotated[
        bool, typer.Option("--strict", help="Status 1 for notes too, not for warnings alone.")
    ] = False,
    ignore: Annotated[
        list[str] | None,
        typer.Option("--ignore", metavar="RULE", help="Leave a rule out. May be given again."),
    ] = None,
    rules: Annotated[
        bool, typer.Option("--list", help="List the rules, and check nothing.")
    ] = False,
    package_path: arguments.PackagePath = None,
    controllers: Annotated[
        list[Path] | None,
        typer.Option(
            "--controllers",
            metavar="FILE",
            help="YAML of ros_control or ros2_control, checked too; may be repeated.",
        ),
    ] = None,
) -> None:
    """Tell what breaks or misleads in a description, where, and what to write instead.

    The exit status is 0 where there is no error and no warning (with --strict no note either), 1
    where there are findings, and 2 where the file cannot be read or is no description.
    """
    from cartwheel.cli.commands import check as work

    if rules:
        work.list_rules()
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
