"""``cartwheel play``: plays a recording."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from cartwheel.cli import arguments, help
from cartwheel.cli.control import parse_speed


def add_to(app: typer.Typer) -> None:
    """Adds the command."""
    help.add(app, play, group=help.SIMULATE)


def play(
    file: Annotated[
        Path, typer.Argument(metavar="FILE", show_default=False, help=arguments.RECORDING)
    ],
    *,
    headless: arguments.Headless = False,
    speed: Annotated[
        str,
        typer.Option(
            metavar="FACTOR|max",
            help="Playback speed: 1 is the recorded speed, max is as fast as possible.",
            rich_help_panel=help.TIME,
        ),
    ] = "1",
    start: Annotated[
        float,
        typer.Option(
            "--start",
            metavar="SECONDS",
            help="Time after the beginning of the recording at which playback starts.",
            rich_help_panel=help.TIME,
        ),
    ] = 0.0,
    loop: Annotated[
        bool,
        typer.Option(
            "--loop", help="Repeat the recording when it ends.", rich_help_panel=help.TIME
        ),
    ] = False,
    paused: arguments.Paused = False,
    world: Annotated[
        str | None,
        typer.Option(
            metavar="FILE|NAME",
            help="World to show around the robot: an SDF file, or the name of a bundled world.",
            rich_help_panel=help.WORLD,
        ),
    ] = None,
    host: arguments.Host = "127.0.0.1",
    allow_origin: arguments.AllowOrigin = None,
    port: arguments.Port = 8080,
    open_browser: arguments.OpenBrowser = None,
    package_path: arguments.PackagePath = None,
) -> None:
    """Play a recording in the browser.

    During playback, the commands topic, pause, resume, speed and reset work as in a simulation.
    """
    from cartwheel.cli.commands import play as work

    work.play(
        work.Options(
            file=file,
            headless=headless,
            speed=parse_speed(speed),
            start=start,
            loop=loop,
            paused=paused,
            world=world,
            host=host,
            allow_origin=tuple(allow_origin or ()),
            port=port,
            open_browser=open_browser,
            package_path=tuple(package_path or ()),
        )
    )
