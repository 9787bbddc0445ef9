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
    file: Annotated[
        Path, typer.Argument(metavar="FILE", show_default=False, help=arguments.RECORDING)
    ],
    *,
    json: Annotated[bool, typer.Option("--json", help="Print the information as JSON.")] = False,
) -> None:
    """List the topics of a recording, with types, counts and rates."""
    from cartwheel.cli.commands import info as work

    work.info(file, as_json=json)
