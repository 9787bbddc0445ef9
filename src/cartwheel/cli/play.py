"""``cartwheel play``: a recording in a simulation's place."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from cartwheel.cli import arguments
from cartwheel.cli.control import parse_speed


def add_to(app: typer.Typer) -> None:
    """Adds the command."""
    app.command()(play)


def play(
    file: Annotated[Path, typer.Argument(metavar="FILE", show_default=False)],
    *,
    headless: arguments.Headless = False,
    speed: Annotated[
        str, typer.Option(metavar="FACTOR|max", help="1 is as it was; max as fast as it can.")
    ] = "1",
    start: Annotated[
        float, typer.Option("--start", metavar="SECONDS", help="After the beginning.")
    ] = 0.0,
    loop: Annotated[bool, typer.Option("--loop", help="Begin again at the end.")] = False,
    paused: arguments.Paused = False,
    world: Annotated[
        str | None, typer.Option(metavar="FILE|NAME", help="Things to show around the robot.")
    ] = None,
    host: arguments.Host = "127.0.0.1",
    allow_origin: arguments.AllowOrigin = None,
    port: arguments.Port = 8080,
    open_browser: arguments.OpenBrowser = None,
    package_path: arguments.PackagePath = None,
) -> None:
    """Play a recording, in the browser and on topics. FILE is .mcap, .bag, .db3 or a folder."""
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
