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
    help,
    info,
    model,
    play,
    run,
    service,
    teleop,
    test,
    topic,
)

app = typer.Typer(
    name="cartwheel",
    cls=help.Group,
    help="Simulate ROS robots from their xacro, URDF or SDF files. Works without ROS, Gazebo and "
    "GPU.",
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
        bool, help.option("--verbose", "Show a traceback if Cartwheel itself fails.")
    ] = False,
    version: Annotated[
        bool,
        help.option(
            "--version", "Show the version and exit.", is_eager=True, callback=_print_version
        ),
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
test.add_to(app)
model.add_to(app)
control.add_to(app)
teleop.add_to(app)
app.add_typer(topic.app, name="topic", rich_help_panel=help.CONTROL)
app.add_typer(service.app, name="service", rich_help_panel=help.CONTROL)
help.add(app, files.version, group=help.OTHER)
