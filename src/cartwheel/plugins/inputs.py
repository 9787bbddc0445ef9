"""Wrappers that reject commands with values that cannot be simulated."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from cartwheel.codes import running
from cartwheel.errors import Code
from cartwheel.messages.limits import unfit
from cartwheel.simulation import Part
from cartwheel.simulation.limits import STRONGEST, number


def checked_callback(
    take: Callable[[Any], None],
    part: Part,
    warn: Callable[[Code, str], None],
    *,
    unset: bool = False,
) -> Callable[[Any], None]:
    """Wraps a callback so that it only receives commands that can be simulated.

    Other commands are ignored. Only the first of them causes a warning.

    Args:
        take: Receives the valid messages.
        part: Counts the valid commands.
        warn: Receives the code and the message of the warning.
        unset: Accept NaN and infinity, which some controllers use for values that are not set.
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
            text = f"a command is ignored because {reason} cannot be simulated"
            warn(
                running.COMMAND_NOT_SIMULATED,
                f"{text} (later ones on this topic are ignored without a warning)",
            )

    return checked


def checked_positions(
    put: Callable[[Mapping[str, float], float], None], part: Part
) -> Callable[[Mapping[str, float], float], None]:
    """Wraps `JointInput.put` so that positions that cannot be simulated raise a CartwheelError."""

    def checked(wanted: Mapping[str, float], seconds: float) -> None:
        for joint, position in wanted.items():
            number(position, f'the position of joint "{joint}"')
        number(seconds, "the duration in s")
        part.count_command()
        put(wanted, seconds)

    return checked
