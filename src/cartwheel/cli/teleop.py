"""``cartwheel teleop``: driving by keys."""

from __future__ import annotations

from typing import Annotated

import typer

from cartwheel.cli.arguments import Sim


def add_to(app: typer.Typer) -> None:
    """Adds the command."""
    app.command()(teleop)


def teleop(
    topic: Annotated[
        str | None,
        typer.Option(metavar="TOPIC", help="Where to publish; else the one Twist read."),
    ] = None,
    speed: Annotated[float, typer.Option(min=0, help="m/s to begin with.")] = 0.5,
    turn: Annotated[float, typer.Option(min=0, help="rad/s to begin with.")] = 1.0,
    sim: Sim = None,
) -> None:
    """Drive by keys, those of teleop_twist_keyboard."""
    from cartwheel.cli.commands import teleop as work

    work.drive(sim, topic, speed=speed, turn=turn)
