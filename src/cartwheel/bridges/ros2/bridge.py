"""The graph of a simulation as a ROS 2 node."""

from __future__ import annotations

import functools
import re
from collections.abc import Callable, Iterable
from typing import Any, Literal

from cartwheel.bridges.bridged import BridgedAction, BridgedGraph
from cartwheel.bridges.loop import Loop
from cartwheel.bridges.mirror import (
    BRIDGES,
    ONLOOKERS,
    Arrivals,
    Closable,
    Copies,
    asked,
    is_available,
    survey,
)
from cartwheel.bridges.ros2.actions import OfferedAction
from cartwheel.bridges.ros2.log import Log
from cartwheel.bridges.ros2.middleware import Endpoint, Middleware, Outlet, publisher
from cartwheel.bridges.ros2.nodes import OwnNode
from cartwheel.bridges.ros2.parameters import NodeParameters, Parameter
from cartwheel.bridges.ros2.qos import DEFAULT, PARAMETER_CALLS
from cartwheel.bridges.ros2.services import Services
from cartwheel.bridges.ros2.type_descriptions import TYPE as DESCRIPTION
from cartwheel.bridges.ros2.type_descriptions import get_type_description
from cartwheel.bridges.tap import Tap
from cartwheel.codes.wires import (
    BRIDGE_FAULT,
    MALFORMED_MESSAGE,
    MESSAGE_NOT_SENT,
    ROS_NODE_NAME_INVALID,
)
from cartwheel.errors import CartwheelError, Diagnostic, GraphError
from cartwheel.graph import Qos, Service, TopicInfo
from cartwheel.messages import decode_cdr
from cartwheel.messages.ros2.types import is_ros1_only, ros2_service, ros2_type
from cartwheel.reporting import Reporter

READER = "ros2"
"""Node name of the bridge in the graph."""
Rmw = Literal["dds", "zenoh"]
_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*\Z")
_MOST_WARNINGS = 500
"""Maximum number of different warnings. They contain node names, whose number is not limited."""
_CLOSING = 10.0
_ROS1_PARTS = ("goal", "cancel", "status", "feedback", "result")
"""Topics of an action in ROS 1. ROS 2 represents them differently."""
_LOOK = 0.2
"""Interval in s at which parameters are checked for changes by others."""

Report = Callable[[Diagnostic], None]


class Ros2Bridge:
    """Connects the topics, services and actions of a graph to ROS 2, as a node.

    The bridge subscribes to the graph only while a ROS node subscribes. ROS need not be installed.

    Args:
        graph: Graph of the simulation.
        node: Name of the node.
        rmw: Middleware of the other nodes.
        parameters: Parameters of the node.
        report: Receives diagnostics for the user, on any thread.
        time_ns: Returns the simulation time, for timestamps.

    Raises:
        CartwheelError: A name or ROS environment variable is invalid, or a package is missing.
    """

    def __init__(
        self,
        graph: BridgedGraph,
        *,
        node: str = "gazebo",
        rmw: Rmw = "dds",
        parameters: Iterable[Parameter] = (),
        report: Report = lambda _: None,
        time_ns: Callable[[], int] = lambda: 0,
    ) -> None:
        if not _NAME.match(node):
            raise CartwheelError(
                f'"{node}" is not a valid name for a ROS 2 node',
                code=ROS_NODE_NAME_INVALID,
                hint="Names may contain letters, digits and _, and must not begin with a digit.",
                values={"name": node},
            )
        self._graph = graph
        self._warn = Reporter(report, _MOST_WARNINGS, title="ROS 2")
        self.name = f"/{node}"
        self._loop = Loop(self._fault, name="ros2")
        self.middleware = _middleware(rmw)(self._loop, self.name, self._warn)
        self._arrivals = Arrivals(graph, self._warn)
        self._log = Log(self._loop, node=node, time_ns=time_ns)
        self._parameters = NodeParameters(self.name, parameters, time_ns=time_ns)
        # The last property of each copy is its ROS 2 node; empty for the main node.
        self._publications: Copies[_Publication] = Copies()
        self._subscriptions: Copies[_Subscription] = Copies()
        self._services: Copies[Closable] = Copies()
        self._actions: Copies[OfferedAction] = Copies()
        self._nodes: Copies[OwnNode] = Copies()
        self._theirs: frozenset[str] = frozenset()
        self._due = False
        self._closed = False
        self._offers = Services(self._loop, self.middleware, self._warn)

    @property
    def description(self) -> str:
        """Description of the middleware."""
        return self.middleware.description

    def start(self) -> None:
        """Connects to ROS. The rest follows on a separate thread.

        Raises:
            CartwheelError: The connection failed.
        """
        self._loop.start()
        self._loop.call(self._begin).result()
        self._graph.on_change.append(self._wake)
        self._wake()

    def close(self) -> None:
        """Disconnects. Returns at once."""
        if self._closed:
            return
        self._closed = True
        if self._wake in self._graph.on_change:
            self._graph.on_change.remove(self._wake)

        def end() -> None:
            for publication in self._publications.values():
                publication.tap.close()
            self.middleware.close()

        self._loop.call(end).result(_CLOSING)
        self._loop.stop()

    def log(self, diagnostic: Diagnostic) -> None:
        """Logs a diagnostic on ``/rosout``. Callable on any thread."""
        self._log.write(diagnostic)

    def make_way(self, last: str, changed: Callable[[frozenset[str]], None]) -> None:
        """Stops publishing topics while other nodes publish them.

        Args:
            last: Last part of the topic names.
            changed: Called with these topics whenever they change, on the loop's thread.
        """

        def look() -> None:
            theirs = self.middleware.topics_of_others()
            found = frozenset(one for one in theirs if one.rpartition("/")[2] == last)
            if found != self._theirs:
                self._theirs = found
                self._mirror()
                changed(found)

        self.middleware.on_others = look
        self._loop.post(look)

    # -- on the loop's thread

    def _begin(self) -> None:
        self.middleware.start()
        self._log.begin(self.middleware)
        self._parameters.begin(
            self.middleware, functools.partial(self._offers.offer, depth=PARAMETER_CALLS)
        )
        self._offers.offer(f"{self.name}/get_type_description", DESCRIPTION, get_type_description)
        self._look_at_parameters()

    def _look_at_parameters(self) -> None:
        """Checks for changes by the web viewer, services and other wires."""
        if not self._closed:
            self._parameters.look()
            self._loop.after(_LOOK, self._look_at_parameters)

    def _wake(self) -> None:
        """Called when the graph has changed, on any thread, with the graph locked."""
        if not self._due:
            self._due = True
            self._loop.post(self._mirror)

    def _mirror(self) -> None:
        self._due = False
        if self._closed:
            return
        actions = {one.name: one for one in self._graph.actions()}
        of_ros1 = {f"{name}/{part}" for name in actions for part in _ROS1_PARTS}
        topics = (info for info in self._graph.topics() if info.name not in of_ros1)
        found = survey(topics, known=lambda info: self._is_known("topic", info, ros2_type))
        self._publications.synchronise(
            {
                name: (info.type, info.qos, self._node_of(info.publishers[0]))
                for name, info in found.sent.items()
                if name not in self._theirs
            },
            lambda name, properties: _Publication(self, name, *properties),
        )
        self._subscriptions.synchronise(
            {name: (info.type, self._reading_node(info)) for name, info in found.read.items()},
            lambda name, properties: _Subscription(self, name, *properties),
        )
        self._services.synchronise(
            {
                one.name: (one.type, self._node_of(one.node))
                for one in self._graph.services()
                if self._is_known("service", one, ros2_service)
            },
            self._offer,
        )
        self._actions.synchronise(
            {name: (one, self._node_of(one.node)) for name, one in actions.items()},
            lambda _, properties: self._offer_action(*properties),
        )
        # The other nodes exist while they have endpoints.
        mirrored = (self._publications, self._subscriptions, self._services, self._actions)
        nodes = {each[-1] for copies in mirrored for each in copies.properties.values()}
        self._nodes.synchronise(
            dict.fromkeys(sorted(nodes - {""}), ()),
            lambda name, _: OwnNode(self.middleware, self._offers, name),
        )

    def _offer(self, name: str, properties: tuple[str, str]) -> Closable:
        type_name, node = properties
        function = functools.partial(asked, self._graph, name)
        return self._offers.offer(name, type_name, function, threaded=True, node=node)

    def _offer_action(self, action: BridgedAction, node: str) -> OfferedAction:
        return OfferedAction(
            self._graph,
            action,
            loop=self._loop,
            middleware=self.middleware,
            services=self._offers,
            warn=self._warn,
            node=node,
        )

    def _node_of(self, node: str) -> str:
        """ROS 2 node of a node in the graph; empty for the main node."""
        return self._graph.nodes.get(node, "")

    def _reading_node(self, info: TopicInfo) -> str:
        """ROS 2 node of the first subscriber that is not a bridge or an onlooker."""
        readers = (name for name in info.subscribers if name not in BRIDGES | ONLOOKERS)
        return self._node_of(next(readers, ""))

    # -- diagnostics

    def _is_known(self, kind: str, one: TopicInfo | Service, find: Callable[[str], object]) -> bool:
        return not is_ros1_only(one.type) and is_available(
            kind, one.name, one.type, ros="ROS 2", find=find, warn=self._warn
        )

    def _fault(self, error: Exception) -> None:
        self._warn(BRIDGE_FAULT.because("unexpected error in the bridge", error))


class _Publication:
    """A topic published from the graph to ROS."""

    def __init__(self, bridge: Ros2Bridge, name: str, type_name: str, qos: Qos, node: str) -> None:
        self._bridge = bridge
        self._name = name
        self._faulty = False
        self.tap = Tap(
            bridge._loop,
            bridge._graph,
            topic=name,
            type_name=type_name,
            reader=READER,
            ignored=lambda message: message in bridge._arrivals,
            take=self._send,
            warn=bridge._warn,
            beyond=lambda: self._outlet.dropped if self._outlet is not None else 0,
        )
        self._outlet: Outlet | None = None
        self._outlet = bridge.middleware.publish(
            publisher(name, type_name, qos, node), self._found_readers
        )

    def close(self) -> None:
        self.tap.close()
        if self._outlet is not None:
            self._outlet.close()

    def _found_readers(self, there: bool) -> None:
        if there:
            self.tap.open()
        else:
            self.tap.close()

    def _send(self, message: Any) -> None:
        if self._outlet is None:
            return
        try:
            self._outlet.send(self._bridge._graph.cdr.encode(message))
        except Exception as error:  # noqa: BLE001 - rosbags does not catch all errors of its code
            if not self._faulty:
                self._faulty = True
                self._bridge._warn(
                    MESSAGE_NOT_SENT.because(
                        f"a message on {self._name} cannot be sent",
                        error,
                        values={"topic": self._name},
                    )
                )


class _Subscription:
    """A topic that the graph receives from ROS."""

    def __init__(self, bridge: Ros2Bridge, name: str, type_name: str, node: str) -> None:
        self._bridge = bridge
        self._name = name
        self._type_name = type_name
        endpoint = Endpoint(name=name, type=ros2_type(type_name), profile=DEFAULT, node=node)
        self.close = bridge.middleware.subscribe(endpoint, self._take).close

    def _take(self, data: bytes) -> None:
        try:
            message = decode_cdr(data, self._type_name)
        except GraphError as error:
            self._bridge._warn(
                MALFORMED_MESSAGE.because(
                    f"a node sent a malformed message on {self._name}",
                    error,
                    values={"topic": self._name},
                )
            )
            return
        self._bridge._arrivals.deliver(self._name, self._type_name, message)


def _middleware(rmw: Rmw) -> type[Middleware]:
    # Import only the one that is used.
    if rmw == "zenoh":
        from cartwheel.bridges.ros2.zenoh import Zenoh

        return Zenoh
    from cartwheel.bridges.ros2.dds import Dds

    return Dds
