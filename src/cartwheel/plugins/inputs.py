"""Checks between the graph and the plugins: commands that cannot be simulated are refused."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from cartwheel.codes import running
from cartwheel.errors import Code
from cartwheel.messages.limits import unfit
from cartwheel.simulation import Part
from cartwheel.simulation.limits import STRONGEST, number


def obeyable(
    take: Callable[[Any], None],
    part: Part,
    warn: Callable[[Code, str], None],
    *,
    unset: bool = False,
) -> Callable[[Any], None]:
    """Wraps a callback so that it only receives commands that can be simulated.

    Other commands are ignored; the first one causes a warning.

    Args:
        take: Receives the valid messages.
        part: Counts the commands.
        warn: Receives the code and the message of the warning.
        unset: Accept NaN and infinity.
    """
    warned = False

    def checked(message: Any) -> None:
        nonlocal warned
        reason = unfit(message, most=STRONGEST, unset=unset)
        if not reason:
            part.count_command()
            take(message)
        elif not warned:
            warned = True
            text = f"a command is ignored, and so are later commands of this kind: {reason}"
            warn(running.COMMAND_NOT_SIMULATED, f"{text} cannot be simulated")

    return checked


def obeyable_positions(
    put: Callable[[Mapping[str, float], float], None], part: Part
) -> Callable[[Mapping[str, float], float], None]:
    """A `JointInput.put` that raises a CartwheelError for positions that cannot be simulated."""

    def checked(wanted: Mapping[str, float], seconds: float) -> None:
        for joint, position in wanted.items():
            number(position, f'the position of joint "{joint}"')
        number(seconds, "the time to get there, in s,")
        part.count_command()
        put(wanted, seconds)

    return checked
