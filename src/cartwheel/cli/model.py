"""``cartwheel spawn``, ``delete`` and ``models``: the models in the world."""

from __future__ import annotations

from typing import Annotated

from cartwheel.cli import arguments, help
from cartwheel.cli.arguments import Sim


def spawn(
    *,
    words: arguments.ModelNames = None,
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
    """Spawn a model from a file, or a bundled model by name."""
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
    model: Annotated[str, help.argument("MODEL", "Name of the model.")],
    sim: Sim = None,
) -> None:
    """Delete a model."""
    from cartwheel.cli.commands import models as work

    work.delete(sim, model)


def models(sim: Sim = None) -> None:
    """List the models in the world, with their poses."""
    from cartwheel.cli.commands import models as work

    work.print_list(sim)
