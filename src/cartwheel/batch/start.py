"""The start of a world, to which it returns before each of its variations."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

import numpy as np

from cartwheel.batch.plan import Vary

if TYPE_CHECKING:
    from cartwheel.api import World

_PROGRAM = "cartwheel"
"""The node of subscriptions that a program makes itself."""


class Start:
    """Changes a world by `vary`, each time from the same state.

    Otherwise, changes such as ``link.mass *= 1.1`` would accumulate, and an episode would depend on
    those before it.

    Args:
        world: The world as it was made.
        vary: Changes it.
    """

    def __init__(self, world: World, vary: Vary) -> None:
        self._vary = vary
        self._state = world.save()
        self._ends: list[Callable[[], None]] = []
        """What ends the faults, subscriptions and timed actions of the last episode. They belong to
        the program, and not to a state."""

    def begin(self, world: World, seed: int) -> None:
        """Returns the world to its start with a new seed, and changes it."""
        for end in self._ends:
            end()
        world.restore(self._state)
        world.reset(seed=seed)
        before = dict(_of_program(world))
        try:
            self._vary(world, np.random.default_rng(seed))
        finally:
            self._ends = [end for key, end in _of_program(world) if key not in before]


def _of_program(world: World) -> Iterator[tuple[object, Callable[[], None]]]:
    """Yields what a program has added to a world, with what ends it."""
    for fault in world.faults:
        yield fault, fault.end
    for subscription in world.graph.subscriptions(_PROGRAM):
        yield subscription, subscription.close
    for alarm in world.session.simulation.alarms.pending:
        yield alarm, alarm.cancel
