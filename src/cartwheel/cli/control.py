"""``cartwheel pause``, ``resume``, ``step``, ``reset``, ``speed`` and ``status``."""

from __future__ import annotations

from typing import Annotated

from cartwheel.cli import help
from cartwheel.cli.arguments import Sim
from cartwheel.codes.command import OPTION_INVALID
from cartwheel.errors import CartwheelError


def parse_speed(text: str) -> float | None:
    """A real-time factor, or None for ``max``.

    Raises:
        CartwheelError: The text is neither.
    """
    if text.lower() in ("max", "inf"):
        return None
    try:
        value = float(text)
    except ValueError:
        value = -1.0
    # The simulation checks the upper limit, because importing it here would be slow.
    if not value > 0:
        raise CartwheelError(
            f'the speed must be a positive number or max (got "{text}")',
            code=OPTION_INVALID,
            hint="1 is real time, 2 is twice as fast, and max is as fast as possible.",
            values={"option": "speed", "value": text},
        )
    return value


def status(sim: Sim = None) -> None:
    """Show the state, time and speed of the simulation."""
    from cartwheel.cli.commands import timing

    timing.print_status(sim)


def pause(sim: Sim = None) -> None:
    """Pause the simulation."""
    from cartwheel.cli.commands import timing

    timing.ask(sim, "pause")


def resume(sim: Sim = None) -> None:
    """Resume a paused simulation."""
    from cartwheel.cli.commands import timing

    timing.ask(sim, "resume")


def step(
    count: Annotated[int, help.argument("[N]", "Number of steps. Default: 1.", min=1)] = 1,
    sim: Sim = None,
) -> None:
    """Pause the simulation, then advance it by N steps."""
    from cartwheel.cli.commands import timing

    timing.ask(sim, "step", count=count)


def reset(sim: Sim = None) -> None:
    """Reset time to zero and all models to their initial poses."""
    from cartwheel.cli.commands import timing

    timing.ask(sim, "reset")


def speed(
    value: Annotated[
        str, help.argument("FACTOR|max", "Real-time factor; max is as fast as possible.")
    ],
    sim: Sim = None,
) -> None:
    """Set the target real-time factor."""
    from cartwheel.cli.commands import timing

    timing.ask(sim, "speed", speed=parse_speed(value))
