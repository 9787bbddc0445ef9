"""Runs a session as a ROS 1 node with Gazebo's services."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from cartwheel.bridges.apart.process import BridgeProcess
from cartwheel.cli.commands.bridges import log_all_on, log_on
from cartwheel.cli.commands.report import Report
from cartwheel.cli.showing import print_diagnostic
from cartwheel.errors import Diagnostic
from cartwheel.gazebo import GazeboApi
from cartwheel.session import Session


class Ros1:
    """The bridge of a session and what belongs to it.

    Args:
        session: To offer.
        process: Of the bridge.
        node: Name of the node.
        arguments: ``name:=value`` of ROS.
        package_path: Where models that are spawned look for packages first.
        report: Tells the user.

    Raises:
        CartwheelError: A name or address is none.
    """

    def __init__(
        self,
        session: Session,
        process: BridgeProcess,
        *,
        node: str,
        arguments: Sequence[str],
        package_path: Sequence[Path],
        report: Report,
    ) -> None:
        self._session = session
        self._report = report
        self._api = GazeboApi(session, package_path=package_path)
        simulation = session.simulation
        self._process = process
        self.name, self.master_uri, _ = process.open(
            session.graph,
            {"node": node, "arguments": tuple(arguments)},
            time_ns=lambda: simulation.time_ns,
            echo=False,
            report=simulation.report,
            handlers={"ended": (self._ended, False)},
        )

    def start(self) -> None:
        """Joins ROS; on the owner's thread, before the run.

        Raises:
            CartwheelError: There is no ROS master, and none can be started.
        """
        self._api.start()
        own, open_ports = self._process.call("start")
        self._report.joined(self.name, self.master_uri, own=own, open_ports=open_ports)
        log_all_on(self._process, self._session.simulation)
        parameters = self._session.graph.parameters
        rate = parameters.get(f"{self.name}/pub_clock_frequency")
        if isinstance(rate, int | float) and not isinstance(rate, bool) and rate > 0:
            self._session.set_clock_rate(float(rate))
        if parameters.get(f"{self.name}/enable_ros_network") is False:
            # As with Gazebo: its plugins' topics stay, and the clock.
            self._api.close()

    def close(self) -> None:
        """Disconnects from ROS."""
        self._process.close()

    def _ended(self, diagnostic: Diagnostic) -> None:
        print_diagnostic(diagnostic)
        simulation = self._session.simulation
        log_on(self._process, simulation, diagnostic)
        simulation.stop()
