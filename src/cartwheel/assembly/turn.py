"""The run of a world on a thread."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from cartwheel.messages.store import finding_with

if TYPE_CHECKING:
    from cartwheel.assembly.turns import Turns
    from cartwheel.session import Session
    from cartwheel.simulation import Simulation


class _World(Protocol):
    """A world that can run."""

    session: Session
    lock: Turns

    def _begin(self) -> int | None:
        """Begins a run, and returns the thread of the run around it."""

    def _finish(self, outer: int | None, *, failed: bool) -> None:
        """Ends a run."""


class Turn:
    """A run of a world, in which the thread has its turn.

    Args:
        world: The world.
    """

    __slots__ = ("_finding", "_outer", "_world")

    def __init__(self, world: _World) -> None:
        self._world = world

    def begin(self) -> Simulation:
        """Begins the run.

        Raises:
            SimulationError: See `World.run`.
        """
        world = self._world
        world.lock.__enter__()
        try:
            self._outer = world._begin()
        except BaseException:
            world.lock.release()
            raise
        return world.session.simulation

    def end(self, *, failed: bool) -> None:
        """Ends the run.

        Args:
            failed: Whether the run has raised an error, which is not replaced by that of a
                connection.

        Raises:
            RecordingError: A recording has failed.
        """
        try:
            self._world._finish(self._outer, failed=failed)
        finally:
            self._world.lock.release()

    def __enter__(self) -> Simulation:
        simulation = self.begin()
        # Plugins of users may call `message_class` at any time.
        self._finding = finding_with(self._world.session.types)
        self._finding.__enter__()
        return simulation

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        self._finding.__exit__()
        self.end(failed=kind is not None)
