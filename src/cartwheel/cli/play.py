"""``cartwheel play``: plays a recording."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cartwheel.cli import arguments, help
from cartwheel.cli.control import parse_speed


def play(
    file: Annotated[Path, help.argument("FILE", arguments.RECORDING)],
    *,
    headless: arguments.Headless = False,
    speed: Annotated[
        str,
        help.option(
            "--speed FACTOR|max",
            "Playback speed: 1 is the recorded speed, max is as fast as possible.",
            help.TIME,
        ),
    ] = "1",
    start: Annotated[
        float,
        help.option(
            "--start SECONDS",
            "Time after the beginning of the recording at which playback starts.",
            help.TIME,
        ),
    ] = 0.0,
    loop: Annotated[
        bool, help.option("--loop", "Repeat the recording when it ends.", help.TIME)
    ] = False,
    paused: arguments.Paused = False,
    world: Annotated[
        str | None,
        help.option(
            "--world FILE|NAME",
            "World to show around the robot: an SDF file, or the name of a bundled world.",
            help.WORLD,
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
