"""All commands, put together."""

from __future__ import annotations

import copy
from collections.abc import Sequence
from typing import Annotated

import typer
from typer.main import get_command_name
from typer.models import CommandInfo

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


for group, commands in {
    help.SIMULATE: (run.run, files.view, play.play, test.test),
    help.FILES: (files.convert, check.check, explain.explain, corpus.corpus, info.info),
    help.CONTROL: (
        *(model.spawn, model.delete, model.models),
        *(control.status, control.pause, control.resume),
        *(control.step, control.reset, control.speed),
        teleop.teleop,
    ),
    help.OTHER: (files.version,),
}.items():
    for command in commands:
        app.command(cls=help.Command, rich_help_panel=group)(command)
app.add_typer(topic.app, name="topic", rich_help_panel=help.CONTROL)
app.add_typer(service.app, name="service", rich_help_panel=help.CONTROL)


def named(words: Sequence[str]) -> typer.Typer:
    """The app for a command line: with the command that its first word names, or with all.

    To build all commands takes longer than many a command.
    """
    name = next((word for word in words if not word.startswith("-")), "")
    commands = [each for each in app.registered_commands if _name(each) == name]
    groups = [each for each in app.registered_groups if each.name == name]
    if not commands and not groups:
        return app
    made = copy.copy(app)
    made.registered_commands, made.registered_groups = commands, groups
    return made


def _name(command: CommandInfo) -> str:
    assert command.callback is not None
    return command.name or get_command_name(command.callback.__name__)
