"""A session as a ROS 2 node."""

from __future__ import annotations

from typing import Any

from cartwheel.assembly.observer import Observer
from cartwheel.assembly.processes import log_all_on
from cartwheel.bridges.apart.process import BridgeProcess
from cartwheel.bridges.ros2 import Parameter, Rmw
from cartwheel.codes.wires import PARAMETER_REFUSED
from cartwheel.errors import CartwheelError
from cartwheel.gazebo.robot_descriptions import TOPIC
from cartwheel.gazebo.robot_states import RobotStates, hold_states
from cartwheel.gazebo.ros2_api import Ros2Api
from cartwheel.session import CLOCK_RATE, Session
from cartwheel.simulation import RunState
from cartwheel.simulation.limits import check_speed

_FASTEST = 1e6
"""Hz."""


class Ros2Connection:
    """The ROS 2 bridge of a session.

    Args:
        session: The session.
        process: The bridge's process, which is closed with the connection.
        api: Gazebo's services; None if they are already offered.
        node: Name of the node.
        rmw: The middleware.
        observer: Is notified.

    Raises:
        CartwheelError: A name or an environment variable of ROS is invalid, or a dependency is
            missing.
    """

    def __init__(
        self,
        session: Session,
        process: BridgeProcess,
        *,
        api: Ros2Api | None,
        node: str,
        rmw: Rmw,
        observer: Observer,
    ) -> None:
        self._session = session
        self._observer = observer
        self._api = api
        simulation = session.simulation
        self._process = process
        self._parameters = {one.name: one for one in node_parameters(session)}
        self.name, self.middleware = process.open(
            session.graph,
            {
                "node": node,
                "rmw": rmw,
                "parameters": [
                    (one.name, one.description, one.set is not None)
                    for one in self._parameters.values()
                ],
            },
            time_ns=lambda: simulation.time_ns,
            echo=False,
            report=simulation.report,
            handlers={
                "values": (self._values, False),
                "set_value": (self._set_value, False),
                "taken_by_others": (self._leave_to_others, False),
            },
        )

    def start(self) -> None:
        """Joins ROS. Call it on the owner's thread.

        Raises:
            CartwheelError: The bridge cannot start.
        """
        if self._api is not None:
            self._api.start()
        hold_states(self._session)
        self._process.call("start")
        self._process.notify("make_way", TOPIC.strip("/"))
        self._observer.ros2_joined(self.name, self.middleware)
        log_all_on(self._process, self._session.simulation)

    def close(self) -> None:
        """Disconnects from ROS."""
        self._process.close()

    # -- for the bridge

    def _values(self) -> tuple[int, dict[str, Any]]:
        values = {name: one.get() for name, one in self._parameters.items()}
        return self._session.simulation.time_ns, values

    def _set_value(self, name: str, value: Any) -> None:
        set_ = self._parameters[name].set
        assert set_ is not None
        set_(value)

    def _leave_to_others(self, topics: frozenset[str]) -> None:
        states = self._session.states
        if isinstance(states, RobotStates):
            self._session.simulation.post(lambda: states.leave_to_others(topics))


def node_parameters(session: Session) -> list[Parameter]:
    """The session's parameters for ``ros2 param``."""
    simulation = session.simulation

    def set_speed(factor: float) -> None:
        # Checked here too, because it is set only after the response.
        check_speed(factor or None)
        simulation.post(lambda: simulation.set_speed(factor or None))

    def set_paused(paused: bool) -> None:
        simulation.post(simulation.pause if paused else simulation.resume)

    rate = [CLOCK_RATE]

    def set_rate(hertz: float) -> None:
        if not 0 <= hertz <= _FASTEST:
            raise CartwheelError(
                f"publish_rate must be between 0 and {_FASTEST:g} (got {hertz:g})",
                code=PARAMETER_REFUSED,
                values={"parameter": "publish_rate", "value": hertz},
            )
        rate[0] = hertz
        simulation.post(lambda: session.set_clock_rate(hertz))

    return [
        Parameter(
            name="max_step_size",
            description="Physics time step, in s.",
            get=lambda: simulation.step_ns / 1e9,
        ),
        Parameter(
            name="paused",
            description="Whether the simulation is paused.",
            get=lambda: simulation.run_state is RunState.PAUSED,
            set=set_paused,
        ),
        Parameter(
            name="publish_rate",
            description="Publish rate of /clock, in Hz of simulated time; 0 publishes at every "
            "step.",
            get=lambda: rate[0],
            set=set_rate,
        ),
        Parameter(
            name="real_time_factor",
            description="Target real-time factor; 0 means as fast as possible.",
            get=lambda: simulation.speed or 0.0,
            set=set_speed,
        ),
        Parameter(
            name="use_sim_time",
            description="Timestamps are in simulated time, which this node publishes.",
            get=lambda: True,
        ),
    ]
