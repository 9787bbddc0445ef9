"""``cartwheel corpus``: robots that others wrote, tried one by one."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from cartwheel.cli import arguments


def add_to(app: typer.Typer) -> None:
    """Adds the command."""
    app.command()(corpus)


def corpus(
    folders: Annotated[list[Path], typer.Argument(metavar="FOLDER|FILE...", show_default=False)],
    json: Annotated[
        bool, typer.Option("--json", help="Write the results as JSON; docs/corpus.md has it.")
    ] = False,
    standing: Annotated[
        float,
        typer.Option("--for", metavar="SECONDS", min=1.0, help="How long each is left standing."),
    ] = 10.0,
    package_path: arguments.PackagePath = None,
) -> None:
    """Try every robot of a folder: does it load, stand, publish, drive and reach?"""
    from cartwheel.cli.commands import corpus as work

    status = work.corpus(folders, package_path or [], json=json, standing=standing)
    if status:
        raise typer.Exit(status)
