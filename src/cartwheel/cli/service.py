"""``cartwheel service``: what can be asked of the simulation's nodes."""

from __future__ import annotations

from typing import Annotated

import typer

from cartwheel.cli.arguments import Sim

app = typer.Typer(help="List and call services.", no_args_is_help=True)


@app.command("list")
def list_services(
    verbose: Annotated[
        bool, typer.Option("-v", "--verbose", help="Also types and who serves.")
    ] = False,
    sim: Sim = None,
) -> None:
    """List the services."""
    from cartwheel.cli.commands import services

    services.print_list(sim, verbose=verbose)


@app.command()
def call(
    service: Annotated[str, typer.Argument(metavar="SERVICE", show_default=False)],
    request: Annotated[list[str] | None, typer.Argument(metavar="[YAML]...")] = None,
    sim: Sim = None,
) -> None:
    """Call a service and print its answer."""
    from cartwheel.cli.commands import services

    services.call(sim, service, request or [])
