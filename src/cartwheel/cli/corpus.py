"""``cartwheel corpus``: try many robots, one by one."""

from __future__ import annotations

from typing import Annotated

import typer

from cartwheel.cli import arguments, help


def corpus(
    words: Annotated[
        list[str],
        help.argument(
            "FOLDER|FILE... [NAME:=VALUE]...",
            "Folders to search, or robot files. NAME:=VALUE sets a xacro argument of the robots "
            "that declare it.",
        ),
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

    folders, values = arguments.folders(words)
    with using(plugin or ()):
        status = work.corpus(
            folders, package_path or [], json=json, standing=standing, arguments=values
        )
    if status:
        raise typer.Exit(status)
