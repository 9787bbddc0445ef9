"""``cartwheel service``: services of the simulation's nodes."""

from __future__ import annotations

from typing import Annotated

import typer

from cartwheel.cli import help
from cartwheel.cli.arguments import Sim

app = typer.Typer(cls=help.Group, help="List and call services.", no_args_is_help=True)


@app.command("list", cls=help.Command)
def list_services(
    verbose: Annotated[bool, help.option("-v --verbose", "Also show types and servers.")] = False,
    sim: Sim = None,
) -> None:
    """List services."""
    from cartwheel.cli.commands import services

    services.print_list(sim, verbose=verbose)


@app.command(cls=help.Command)
def call(
    service: Annotated[str, help.argument("SERVICE", "Name of the service.")],
    request: Annotated[
        list[str] | None,
        help.argument("[YAML]...", "Request. Default: the fields' default values."),
    ] = None,
    sim: Sim = None,
) -> None:
    """Call a service and print the response."""
    from cartwheel.cli.commands import services

    services.call(sim, service, request or [])
