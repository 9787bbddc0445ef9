"""``cartwheel explain``: what a diagnostic code means."""

from __future__ import annotations

from typing import Annotated

import typer


def add_to(app: typer.Typer) -> None:
    """Adds the command."""
    app.command()(explain)


def explain(
    codes: Annotated[
        list[str] | None,
        typer.Argument(metavar="[CODE]...", show_default=False, help="A number or a name."),
    ] = None,
    json: Annotated[bool, typer.Option("--json", help="Write JSON.")] = False,
) -> None:
    """Explain diagnostic codes, such as CW204; without a code, list all of them."""
    from cartwheel.cli.commands import explain as work

    work.explain(codes or [], json=json)
