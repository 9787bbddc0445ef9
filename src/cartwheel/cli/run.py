"""``cartwheel run``: a robot in a world."""

from __future__ import annotations

from typing import Annotated

import typer

from cartwheel.cli import arguments
from cartwheel.cli.control import parse_speed


def add_to(app: typer.Typer) -> None:
    """Adds the command."""
    app.command()(run)


def run(
    *,
    words: arguments.Names = None,
    world: Annotated[
        str | None, typer.Option(metavar="FILE|NAME", help="A world's file, or a shipped one.")
    ] = None,
    headless: Annotated[bool, typer.Option("--headless", help="Without the viewer.")] = False,
    speed: Annotated[
        str, typer.Option(metavar="FACTOR|max", help="1 is real time; max as fast as it can.")
    ] = "1",
    seconds: Annotated[
        float | None, typer.Option("--for", metavar="SECONDS", help="Of simulated time, then end.")
    ] = None,
    paused: Annotated[bool, typer.Option("--paused", help="Begin with time held.")] = False,
    seed: Annotated[int, typer.Option(min=0, help="Of all noise.")] = 0,
    strict: Annotated[bool, typer.Option("--strict", help="Make every warning an error.")] = False,
    host: arguments.Host = "127.0.0.1",
    port: arguments.Port = 8080,
    open_browser: Annotated[
        bool | None, typer.Option("--open/--no-open", help="Open the browser; on a desktop it is.")
    ] = None,
    x: arguments.X = None,
    y: arguments.Y = None,
    z: arguments.Z = None,
    roll: arguments.Roll = None,
    pitch: arguments.Pitch = None,
    yaw: arguments.Yaw = None,
    model: arguments.Model = None,
    package_path: arguments.PackagePath = None,
    verbose: Annotated[
        bool, typer.Option("--verbose", help="Also say what is merely worth knowing.")
    ] = False,
) -> None:
    """Simulate a robot: FILE is a xacro, URDF or SDF; the shipped cart where none is given.

    FILE may also be a world, which then stands alone. NAME:=VALUE sets an argument of the
    xacro file; world:=FILE is the same as --world.
    """
    from cartwheel.cli.commands.run import Options, simulate

    file, values = arguments.split(words)
    simulate(
        Options(
            file=file,
            values=values,
            world=world,
            headless=headless,
            speed=parse_speed(speed),
            seconds=seconds,
            paused=paused,
            seed=seed,
            strict=strict,
            host=host,
            port=port,
            open_browser=open_browser,
            place=arguments.pose(x=x, y=y, z=z, roll=roll, pitch=pitch, yaw=yaw),
            model=model,
            package_path=tuple(package_path or ()),
            verbose=verbose,
        )
    )
