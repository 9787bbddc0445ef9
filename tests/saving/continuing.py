"""Compares a world that goes on with one that was saved and restored, or reset."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from tests.saving.journeys import Journey, continued, traveller

SEED = 3
"""The new seed of a reset."""


def compare(
    file: Path,
    elsewhere: Callable[..., Any],
    times: tuple[float, float] = (1.0, 0.5),
    *,
    resets: bool = False,
) -> list[str]:
    """Compares the continuations: in the same world, and in a new world elsewhere.

    Args:
        file: A robot, or a world with a robot.
        elsewhere: Calls a function in another process.
        times: Seconds until the world is saved, and after.
        resets: Whether to compare the world after a reset with a new one, too.

    Returns:
        What the saved state leaves out, without subscribers.
    """
    who = traveller(file)
    journey = Journey(who)
    with journey.world as world:
        journey.set_out(times[0])
        state = world.save()
        expected = journey.go_on(times[1])
        world.restore(state)
        assert journey.go_on(times[1]) == expected
        if resets:
            world.reset(seed=SEED)
            again = journey.go_on(times[1])
    # The world is closed, because two worlds cannot use the same port.
    assert elsewhere(continued, file, state, who.height, times[1]) == expected
    if resets:
        new = Journey(who, seed=SEED)
        with new.world:
            assert new.go_on(times[1]) == again
    return [each for each in state.left_out if not each.startswith("subscriber")]
