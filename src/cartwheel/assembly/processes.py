"""The bridge processes of a run."""

from __future__ import annotations

import functools
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from cartwheel.errors import Diagnostic

if TYPE_CHECKING:
    from cartwheel.bridges.apart.process import BridgeProcess
    from cartwheel.simulation import Simulation

Kind = Literal["ros1", "ros2", "foxglove"]
_TITLES = {"ros1": "ROS 1", "ros2": "ROS 2", "foxglove": "Foxglove"}


class Processes:
    """Bridge processes that start up while the simulation's files are read."""

    def __init__(self) -> None:
        self._ready: dict[Kind | Path, BridgeProcess] = {}

    def start(self, kind: Kind | Path) -> None:
        """Starts the process of a bridge, or of the recording with this path."""
        # The import is slow, and not every run has bridges.
        from cartwheel.bridges.apart.process import BridgeProcess

        if isinstance(kind, Path):
            made = BridgeProcess("recording", f"the recording {kind}", patient=True)
        else:
            made = BridgeProcess(kind, _TITLES[kind])
        self._ready[kind] = made

    def take(self, kind: Kind | Path) -> BridgeProcess:
        """A process that was started earlier, or a new one. The caller closes it."""
        if kind not in self._ready:
            self.start(kind)
        return self._ready.pop(kind)

    def close(self) -> None:
        """Stops all processes that were not taken."""
        while self._ready:
            self._ready.popitem()[1].close()


def log_on(process: BridgeProcess, simulation: Simulation, diagnostic: Diagnostic) -> None:
    """Logs a diagnostic on the ``/rosout`` of a bridge."""
    process.notify("log", diagnostic, simulation.time_ns)


def log_all_on(process: BridgeProcess, simulation: Simulation) -> None:
    """Logs all past and future diagnostics there."""
    engine = simulation.engine
    for diagnostic in engine.diagnostics:
        log_on(process, simulation, diagnostic)
    engine.on_diagnostic.append(functools.partial(log_on, process, simulation))
