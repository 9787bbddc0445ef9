"""Compares a world that goes on with one that was saved and restored."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from tests.saving.journeys import Journey, continued


def compare(
    file: Path, elsewhere: Callable[..., Any], times: tuple[float, float] = (1.0, 0.5)
) -> list[str]:
    """Compares the continuations: in the same world, twice, and in a new world elsewhere.

    Args:
        file: A robot, or a world with a robot.
        elsewhere: Calls a function in another process.
        times: Seconds until the world is saved, and after.

    Returns:
        What the saved state leaves out, without subscribers.
    """
    journey = Journey(file)
    with journey.world as world:
        journey.set_out(times[0])
        state = world.save()
        expected = journey.go_on(times[1])
        for _ in range(2):
            world.restore(state)
            assert journey.go_on(times[1]) == expected
    # The world is closed, because two worlds cannot use the same port.
    assert elsewhere(continued, file, state, journey.height, times[1]) == expected
    return [each for each in state.left_out if not each.startswith("subscriber")]
