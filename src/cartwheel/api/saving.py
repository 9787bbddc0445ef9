"""Saves, restores and resets the state of a world."""

from __future__ import annotations

import threading
from collections.abc import Iterator

from cartwheel.api.exchange.lockstep import SteppedWorld
from cartwheel.api.values import instance
from cartwheel.codes.world import RUN_NESTED
from cartwheel.errors import SimulationError
from cartwheel.saving import State, restore, save
from cartwheel.simulation.limits import check_seed


class SavingWorld(SteppedWorld):
    """The part of `World` that saves, restores and resets its state."""

    def save(self) -> State:
        """Saves the state: physics, plugins, controllers, commands and noise.

        A world that restores the state continues bit for bit as this one: with the same commands,
        it reaches the same states and publishes the same messages.

        Subscribers and callbacks of the program, connections and recordings are not part of the
        state; `State.left_out` lists them.

        Raises:
            SimulationError: The world is closed, or a callback of the same world called the method.
        """
        with self._used():
            if self.lock.runner == threading.get_ident():
                raise _nested("saves")
            return save(self.session, tuple(self._left_out()))

    def restore(self, state: State) -> None:
        """Restores a state of this world, or of a world that was made in the same way.

        Models that were spawned since are deleted, and deleted models are spawned again. The state
        can be restored any number of times. Subscribers of the program remain.

        Args:
            state: The result of `save`, which may have been pickled.

        Raises:
            SimulationError: The world is running or closed, or differs from the saved one.
            CartwheelError: A deleted model cannot be spawned again. The world is unchanged after
                each of these errors.
        """
        instance(state, State, "state", "state = world.save()")
        with self._used(change=True):
            if self.lock.runner is not None:
                raise _nested("restores")
            restore(self.session, state)

    def reset(self, seed: int | None = None) -> None:
        """Resets simulation time and all models to their initial state.

        Args:
            seed: New seed for all noise, as for `World`; None for the same seed.

        Raises:
            CartwheelError: The seed is not an integer of at least 0.
            SimulationError: The world is closed.
        """
        check_seed(seed)
        with self._used(change=True) as simulation:
            simulation.reset(seed=seed)

    def _left_out(self) -> Iterator[str]:
        yield from super()._left_out()
        if self._connections is not None:
            yield "connections and recordings"


def _nested(what: str) -> SimulationError:
    return SimulationError(
        f"the world {what} its state while it runs",
        code=RUN_NESTED,
        hint="Call save and restore between two runs.",
    )
