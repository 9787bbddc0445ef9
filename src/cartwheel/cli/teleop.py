"""``cartwheel teleop``: drive a robot with keys."""

from __future__ import annotations

from typing import Annotated

from cartwheel.cli import help
from cartwheel.cli.arguments import Sim


def teleop(
    topic: Annotated[
        str | None,
        help.option(
            "--topic TOPIC",
            "Topic of the velocity commands. Default: the only topic with a Twist subscriber.",
        ),
    ] = None,
    speed: Annotated[float, help.option("--speed M/S", "Initial linear speed.", min=0)] = 0.5,
    turn: Annotated[float, help.option("--turn RAD/S", "Initial angular speed.", min=0)] = 1.0,
    sim: Sim = None,
) -> None:
    """Drive a robot with the keys of teleop_twist_keyboard."""
    from cartwheel.cli.commands import teleop as work

    work.drive(sim, topic, speed=speed, turn=turn)
