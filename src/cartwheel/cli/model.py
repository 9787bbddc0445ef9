"""``cartwheel spawn``, ``delete`` and ``models``: what stands in the world."""

from __future__ import annotations

from typing import Annotated

import typer

from cartwheel.cli import arguments
from cartwheel.cli.arguments import Sim


def add_to(app: typer.Typer) -> None:
    """Adds the commands."""
    app.command()(spawn)
    app.command()(delete)
    app.command("models")(models)


def spawn(
    *,
    words: arguments.Names = None,
    x: arguments.X = None,
    y: arguments.Y = None,
    z: arguments.Z = None,
    roll: arguments.Roll = None,
    pitch: arguments.Pitch = None,
    yaw: arguments.Yaw = None,
    model: arguments.Model = None,
    package_path: arguments.PackagePath = None,
    sim: Sim = None,
) -> None:
    """Put a model into the running simulation: a file, or the name of a shipped model."""
    from cartwheel.cli.commands import models as work

    file, values = arguments.split(words)
    work.spawn(
        sim,
        arguments.needed(file),
        values,
        place=arguments.place(x=x, y=y, z=z, roll=roll, pitch=pitch, yaw=yaw),
        model=model,
        package_path=package_path or [],
    )


def delete(
    model: Annotated[str, typer.Argument(metavar="MODEL", show_default=False)], sim: Sim = None
) -> None:
    """Take a model out of the running simulation."""
    from cartwheel.cli.commands import models as work

    work.delete(sim, model)


def models(sim: Sim = None) -> None:
    """List what stands in the world."""
    from cartwheel.cli.commands import models as work

    work.print_list(sim)
