"""``cartwheel info``: the contents of a recording."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from cartwheel.cli import arguments, help


def add_to(app: typer.Typer) -> None:
    """Adds the command."""
    help.add(app, info, group=help.FILES)


def info(
    file: Annotated[Path, help.argument("FILE", arguments.RECORDING)],
    *,
    json: Annotated[bool, help.option("--json", "Print the information as JSON.")] = False,
) -> None:
    """List the topics of a recording, with types, counts and rates."""
    from cartwheel.cli.commands import info as work

    work.info(file, as_json=json)
