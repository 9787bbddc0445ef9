"""Serves a simulation to Foxglove."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

from cartwheel.cli import interrupts
from cartwheel.cli.commands.assets import Assets
from cartwheel.cli.commands.bridges import log_all_on
from cartwheel.cli.commands.options import Options
from cartwheel.cli.commands.report import Report
from cartwheel.codes.wires import SEEK_UNSUPPORTED
from cartwheel.errors import CartwheelError
from cartwheel.gate.access import Access
from cartwheel.simulation import RunState

if TYPE_CHECKING:
    from cartwheel.bridges.apart.process import BridgeProcess
    from cartwheel.bridges.foxglove.controls import TimeState
    from cartwheel.session import Session
    from cartwheel.simulation import Simulation


@contextlib.contextmanager
def shown_by_foxglove(
    session: Session,
    process: BridgeProcess,
    options: Options,
    access: Access,
    report: Report,
) -> Iterator[None]:
    """Serves the enclosed run to Foxglove.

    Raises:
        CartwheelError: The optional dependency is missing, or the port is in use.
    """
    from cartwheel.gazebo.ros2_api import Ros2Api

    simulation = session.simulation
    end_ns = None if options.seconds is None else round(options.seconds * 1e9)
    controls = SimulationControls(simulation)

    with interrupts.finally_do(process.close):
        process.open(
            session.graph,
            {
                "name": f"Cartwheel: {', '.join(simulation.models)}",
                "access": access,
                "port": options.foxglove_port,
                "time_range": None if end_ns is None else (0, end_ns),
            },
            time_ns=lambda: simulation.time_ns,
            echo=True,
            report=simulation.report,
            handlers={
                "state": (controls.state, False),
                "pause": (controls.pause, True),
                "resume": (controls.resume, True),
                "set_speed": (controls.set_speed, True),
                "seek": (controls.seek, True),
                "asset": (Assets(session, options.package_path), True),
            },
        )
        if options.ros1_node is None and options.ros2_node is None:
            # Without ROS, no other bridge offers Gazebo's services.
            Ros2Api(session, package_path=options.package_path).start()
        url = process.call("start")
        log_all_on(process, simulation)
        report.foxglove(url, access)
        yield


class SimulationControls:
    """Time control of a simulation. Thread-safe."""

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation

    @property
    def time_ns(self) -> int:
        """The simulation time."""
        return self._simulation.time_ns

    def state(self) -> TimeState:
        """The run state; these values may be read while they change."""
        from cartwheel.bridges.foxglove.controls import TimeState

        simulation = self._simulation
        return TimeState(
            time_ns=simulation.time_ns,
            paused=simulation.run_state is not RunState.RUNNING,
            speed=simulation.speed,
        )

    def pause(self) -> None:
        """Pauses the simulation."""
        self._do(self._simulation.pause)

    def resume(self) -> None:
        """Resumes the simulation."""
        self._do(self._simulation.resume)

    def set_speed(self, speed: float | None) -> None:
        """Sets the target real-time factor."""
        self._do(lambda: self._simulation.set_speed(speed))

    def seek(self, time_ns: int) -> None:
        """Resets the simulation to the start, the only time that it can seek to.

        Raises:
            CartwheelError: The requested time is not the start.
        """
        if time_ns > 0:
            raise CartwheelError(
                "a simulation cannot seek; it can only be reset", code=SEEK_UNSUPPORTED
            )
        self._do(self._simulation.reset)

    def _do(self, function: Callable[[], None]) -> None:
        # Wait, so that the client receives the resulting state.
        with contextlib.suppress(TimeoutError):
            self._simulation.call(function).result(5.0)
