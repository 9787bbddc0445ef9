"""``cartwheel teleop``: drive a robot with keys."""

from __future__ import annotations

from typing import Annotated

import typer

from cartwheel.cli import help
from cartwheel.cli.arguments import Sim


def add_to(app: typer.Typer) -> None:
    """Adds the command."""
    help.add(app, teleop, group=help.CONTROL)


def teleop(
    topic: Annotated[
        str | None,
        typer.Option(
            metavar="TOPIC",
            help="Topic of the velocity commands. Default: the only topic with a Twist subscriber.",
        ),
    ] = None,
    speed: Annotated[float, typer.Option(min=0, metavar="M/S", help="Initial linear speed.")] = 0.5,
    turn: Annotated[
        float, typer.Option(min=0, metavar="RAD/S", help="Initial angular speed.")
    ] = 1.0,
    sim: Sim = None,
) -> None:
    """Drive a robot with the keys of teleop_twist_keyboard."""
    from cartwheel.cli.commands import teleop as work

    work.drive(sim, topic, speed=speed, turn=turn)
