"""Checks the state for divergence while time advances, and limits recovery."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from cartwheel.codes import world as world_codes
from cartwheel.errors import DivergedError, Origin
from cartwheel.simulation.dynamics.divergence import Guard
from cartwheel.simulation.engine import Engine

_INTERVAL_NS = 100_000_000
"""Simulation time between two checks. At its multiples, tasks with usual rates are due, too, so the
checks do not interrupt the physics again."""
_FIRST_NS = 10_000_000
"""Simulation time until the first check of a new state."""
_RECOVERIES = 20
"""Maximum number of recovery reports: remote commands may cause divergence repeatedly."""


class Watch:
    """Checks an engine's state at intervals, and decides whether a diverged simulation recovers."""

    def __init__(self, engine: Engine) -> None:
        self._engine = engine
        self._guard = Guard()
        self.due = 1
        """The step of the next check."""
        self.interval = 1
        """A check is due at the multiples of so many steps, whatever has happened before."""
        self._recovered = 0
        """`Engine.commanded` at the last recovery."""
        self._recoveries = 0

    def bind(self, model: Any, data: Any) -> None:
        """Continues with a newly compiled model and its data; the next check is due soon."""
        self.interval = max(1, _INTERVAL_NS // self._engine.step_ns)
        self._wait_for_first()
        self._guard.bind(model, data)

    def forget(self) -> None:
        """Discards the stored states after a reset; the next check is due soon."""
        self._wait_for_first()
        self._guard.forget()

    def check(self, origin_of: Callable[[str], Origin | None]) -> None:
        """Checks the state now, reports MuJoCo's warnings, and stores the state for a dump.

        Args:
            origin_of: Returns the origin of a body, by its name in the MuJoCo model.

        Raises:
            DivergedError: The state is no longer finite.
        """
        self.due = self._next()
        for message in self._guard.check(origin_of):
            self._engine.report(world_codes.PHYSICS_WARNING.diagnostic(message))

    def _next(self) -> int:
        """The next multiple of the interval."""
        return (self._engine.step // self.interval + 1) * self.interval

    def _wait_for_first(self) -> None:
        steps = max(1, _FIRST_NS // self._engine.step_ns)
        self.due = min(self._engine.step + steps, self._next())

    def begin_recovery(self) -> bool:
        """Whether an external action since the last recovery may have caused the divergence.

        A world that diverges without external actions would diverge again.
        """
        if self._engine.commanded == self._recovered:
            return False
        self._recovered = self._engine.commanded
        return True

    def report_recovery(self, error: DivergedError) -> None:
        """Reports that all models were reset; only the first 20 recoveries are reported."""
        self._recoveries += 1
        if self._recoveries > _RECOVERIES:
            return
        last = self._recoveries == _RECOVERIES
        end = " Further divergences are not reported." if last else ""
        self._engine.report(
            world_codes.SIMULATION_RECOVERED.diagnostic(
                f"{error.message}; all models are reset to the poses at which they were spawned",
                origin=error.origin,
                hint=f"{error.hint}{end}",
                values=error.values,
            )
        )
