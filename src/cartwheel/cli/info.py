"""``cartwheel info``: what a recording holds."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def add_to(app: typer.Typer) -> None:
    """Adds the command."""
    app.command()(info)


def info(
    file: Annotated[Path, typer.Argument(metavar="FILE", show_default=False)],
    *,
    json: Annotated[bool, typer.Option("--json", help="As JSON.")] = False,
) -> None:
    """List a recording: topics, types, counts, rates. FILE is .mcap, .bag, .db3 or a folder."""
    from cartwheel.cli.commands import info as work

    work.info(file, as_json=json)
