"""A session with a server for Foxglove."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from cartwheel.assembly.assets import Assets
from cartwheel.assembly.observer import Observer
from cartwheel.assembly.processes import log_all_on
from cartwheel.codes.wires import SEEK_UNSUPPORTED
from cartwheel.errors import CartwheelError
from cartwheel.gate.access import Access
from cartwheel.simulation import RunState

if TYPE_CHECKING:
    from cartwheel.bridges.apart.process import BridgeProcess
    from cartwheel.bridges.foxglove.controls import TimeState
    from cartwheel.gazebo.ros2_api import Ros2Api
    from cartwheel.session import Session
    from cartwheel.simulation import Simulation


class FoxgloveServer:
    """The Foxglove bridge of a session.

    Args:
        session: The session.
        process: The bridge's process, which is closed with the server.
        access: Who may connect.
        port: Port to listen on; 0 selects a free port.
        end_ns: Simulation time at which the run ends; None if unlimited.
        package_path: Folders to search for packages first.
        observer: Is notified.

    Raises:
        CartwheelError: The optional dependency is missing, or the port is in use.
    """

    def __init__(
        self,
        session: Session,
        process: BridgeProcess,
        *,
        access: Access,
        port: int,
        end_ns: int | None,
        package_path: Sequence[Path],
        observer: Observer,
    ) -> None:
        simulation = session.simulation
        controls = SimulationControls(simulation)
        self._session = session
        self._process = process
        self._access = access
        self._observer = observer
        self.url = ""
        """URL for Foxglove, after `start`."""
        process.open(
            session.graph,
            {
                "name": f"Cartwheel: {', '.join(simulation.models)}",
                "access": access,
                "port": port,
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
                "asset": (Assets(session, package_path), True),
            },
        )

    def start(self, api: Ros2Api | None) -> None:
        """Starts the server. Call it on the owner's thread.

        Args:
            api: Gazebo's services, unless a ROS connection offers them.

        Raises:
            CartwheelError: The server cannot start.
        """
        if api is not None:
            api.start()
        self.url = self._process.call("start")
        log_all_on(self._process, self._session.simulation)
        self._observer.foxglove_served(self.url, self._access)

    def close(self) -> None:
        """Stops the server."""
        self._process.close()


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
                "a simulation cannot jump to a different time; it can only be reset to its start",
                code=SEEK_UNSUPPORTED,
            )
        self._do(self._simulation.reset)

    def _do(self, function: Callable[[], None]) -> None:
        # Wait, so that the client receives the resulting state.
        with contextlib.suppress(TimeoutError):
            self._simulation.call(function).result(5.0)
