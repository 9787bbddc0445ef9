"""A session as a ROS 1 node with Gazebo's services."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from cartwheel.assembly.observer import Observer
from cartwheel.assembly.processes import log_all_on, log_on
from cartwheel.bridges.apart.process import BridgeProcess
from cartwheel.errors import Diagnostic
from cartwheel.gazebo import GazeboApi
from cartwheel.session import Session


class Ros1Connection:
    """The ROS 1 bridge of a session.

    Args:
        session: The session.
        process: The bridge's process, which is closed with the connection.
        api: Gazebo's services; None if they are already offered.
        node: Name of the node.
        arguments: ROS arguments ``name:=value``.
        observer: Is notified.
        ended: Called when another node has replaced this one, on any thread.

    Raises:
        CartwheelError: A name or address is invalid.
    """

    def __init__(
        self,
        session: Session,
        process: BridgeProcess,
        *,
        api: GazeboApi | None,
        node: str,
        arguments: Sequence[str],
        observer: Observer,
        ended: Callable[[Diagnostic], None],
    ) -> None:
        self._session = session
        self._observer = observer
        self._on_end = ended
        self._api = api
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
        """Joins ROS. Call it on the owner's thread.

        Raises:
            CartwheelError: No ROS master is running, and none can be started.
        """
        if self._api is not None:
            self._api.start()
        own, open_ports = self._process.call("start")
        self._observer.ros1_joined(self.name, self.master_uri, own=own, open_ports=open_ports)
        log_all_on(self._process, self._session.simulation)
        parameters = self._session.graph.parameters
        rate = parameters.get(f"{self.name}/pub_clock_frequency")
        if isinstance(rate, int | float) and not isinstance(rate, bool) and rate > 0:
            self._session.set_clock_rate(float(rate))
        if parameters.get(f"{self.name}/enable_ros_network") is False and self._api:
            # As in Gazebo, the topics of plugins and the clock remain.
            self._api.close()

    def close(self) -> None:
        """Disconnects from ROS."""
        self._process.close()

    def _ended(self, diagnostic: Diagnostic) -> None:
        self._observer.disconnected(diagnostic)
        log_on(self._process, self._session.simulation, diagnostic)
        self._on_end(diagnostic)
