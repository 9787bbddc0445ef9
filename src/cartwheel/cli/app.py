"""All commands, put together."""

from __future__ import annotations

from typing import Annotated

import typer

from cartwheel.cli import (
    check,
    control,
    corpus,
    explain,
    files,
    info,
    model,
    play,
    run,
    service,
    teleop,
    topic,
)

app = typer.Typer(
    name="cartwheel",
    help="Simulates the robot you described: xacro, URDF or SDF with its <gazebo> tags.",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _print_version(wanted: bool) -> None:
    if wanted:
        files.version()
        raise typer.Exit


@app.callback()
def options(
    verbose: Annotated[
        bool, typer.Option("--verbose", help="Show the traceback of a fault of Cartwheel.")
    ] = False,
    version: Annotated[
        bool, typer.Option("--version", is_eager=True, callback=_print_version, help="Print it.")
    ] = False,
) -> None:
    """Options of all commands."""


run.add_to(app)
files.add_to(app)
check.add_to(app)
explain.add_to(app)
corpus.add_to(app)
info.add_to(app)
play.add_to(app)
model.add_to(app)
control.add_to(app)
teleop.add_to(app)
app.add_typer(topic.app, name="topic")
app.add_typer(service.app, name="service")
