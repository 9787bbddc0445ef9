"""The bridge processes of a simulation, one per wire protocol."""

from __future__ import annotations

import contextlib
import functools
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from cartwheel.cli.commands.options import Options
from cartwheel.errors import Diagnostic

if TYPE_CHECKING:
    from cartwheel.bridges.apart.process import BridgeProcess
    from cartwheel.simulation import Simulation


@dataclass(slots=True)
class Bridges:
    """The requested bridges."""

    ros1: BridgeProcess | None = None
    ros2: BridgeProcess | None = None
    foxglove: BridgeProcess | None = None
    recorders: dict[Path, BridgeProcess] = field(default_factory=dict)


@contextlib.contextmanager
def bridges_for(options: Options) -> Iterator[Bridges]:
    """Starts the bridges, which start up while the simulation's files are read."""
    found = Bridges()
    wanted = (options.ros1_node, options.ros2_node, options.foxglove_port)
    if not options.record and all(each is None for each in wanted):
        yield found
        return
    from cartwheel.bridges.apart.process import BridgeProcess

    with contextlib.ExitStack() as stack:

        def started(kind: str, title: str, *, patient: bool = False) -> BridgeProcess:
            made = BridgeProcess(kind, title, patient=patient)
            stack.callback(made.close)
            return made

        if options.ros1_node is not None:
            found.ros1 = started("ros1", "ROS 1")
        if options.ros2_node is not None:
            found.ros2 = started("ros2", "ROS 2")
        if options.foxglove_port is not None:
            found.foxglove = started("foxglove", "Foxglove")
        for path in options.record:
            found.recorders[path] = started("recording", f"the recording {path}", patient=True)
        yield found


def log_on(process: BridgeProcess, simulation: Simulation, diagnostic: Diagnostic) -> None:
    """Logs a diagnostic on the ``/rosout`` of a bridge."""
    process.tell("log", diagnostic, simulation.time_ns)


def log_all_on(process: BridgeProcess, simulation: Simulation) -> None:
    """Logs all past and future diagnostics there."""
    engine = simulation.engine
    for diagnostic in engine.diagnostics:
        log_on(process, simulation, diagnostic)
    engine.on_diagnostic.append(functools.partial(log_on, process, simulation))
