"""``cartwheel corpus``: try many robots, one by one."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from cartwheel.cli import arguments, help


def corpus(
    folders: Annotated[
        list[Path], help.argument("FOLDER|FILE...", "Folders to search, or robot files.")
    ],
    json: Annotated[bool, help.option("--json", "Print the results as JSON.")] = False,
    standing: Annotated[
        float,
        help.option(
            "--for SECONDS", "Simulated time for which each robot must stand still.", min=1.0
        ),
    ] = 10.0,
    package_path: arguments.PackagePath = None,
    plugin: arguments.Plugin = None,
) -> None:
    """Test whether each robot in a folder loads, stands and moves."""
    from cartwheel.cli.commands import corpus as work
    from cartwheel.dialects.plugin_files import using

    with using(plugin or ()):
        status = work.corpus(folders, package_path or [], json=json, standing=standing)
    if status:
        raise typer.Exit(status)
