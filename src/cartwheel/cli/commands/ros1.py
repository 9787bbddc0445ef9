"""A run as a node of ROS 1, with Gazebo's own services."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from cartwheel.bridges.ros1 import Ros1Bridge
from cartwheel.cli.commands.report import Report
from cartwheel.cli.console import print_warning
from cartwheel.errors import Diagnostic
from cartwheel.gazebo import GazeboApi
from cartwheel.session import Session


class Ros1:
    """The bridge of a session and what belongs to it.

    Args:
        session: To offer.
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
        self._bridge = Ros1Bridge(
            session.graph,
            node=node,
            arguments=arguments,
            report=simulation.report,
            time_ns=lambda: simulation.time_ns,
            on_end=self._ended,
        )

    @property
    def master_uri(self) -> str:
        """Of the ROS master."""
        return self._bridge.master_uri

    def start(self) -> None:
        """Joins ROS; on the owner's thread, before the run.

        Raises:
            CartwheelError: There is no ROS master, and none can be started.
        """
        self._api.start()
        self._bridge.start()
        self._report.joined(
            self._bridge.name, self._bridge.master_uri, own=self._bridge.has_own_master
        )
        engine = self._session.simulation.engine
        for diagnostic in engine.diagnostics:
            self._bridge.log(diagnostic)
        engine.on_diagnostic.append(self._bridge.log)
        parameters = self._session.graph.parameters
        rate = parameters.get(f"{self._bridge.name}/pub_clock_frequency")
        if isinstance(rate, int | float) and not isinstance(rate, bool) and rate > 0:
            self._session.set_clock_rate(float(rate))
        if parameters.get(f"{self._bridge.name}/enable_ros_network") is False:
            # As with Gazebo: its plugins' topics stay, and the clock.
            self._api.close()

    def close(self) -> None:
        """Leaves ROS."""
        self._bridge.close()

    def _ended(self, reason: str) -> None:
        print_warning(reason)
        self._bridge.log(Diagnostic(severity="warning", message=reason))
        self._session.simulation.stop()
