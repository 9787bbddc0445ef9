"""The graph of a simulation as a ROS 2 node."""

from __future__ import annotations

import functools
import re
from collections.abc import Callable, Iterable, Mapping
from typing import Any, Literal

from cartwheel.bridges.bridged import BridgedAction, BridgedGraph
from cartwheel.bridges.loop import Loop
from cartwheel.bridges.mirror import BRIDGES, ONLOOKERS, Arrivals, asked, survey
from cartwheel.bridges.ros2.actions import OfferedAction
from cartwheel.bridges.ros2.log import Log
from cartwheel.bridges.ros2.middleware import (
    DEFAULT,
    PARAMETER_CALLS,
    Closable,
    Middleware,
    Outlet,
    profile_of,
)
from cartwheel.bridges.ros2.nodes import OwnNode
from cartwheel.bridges.ros2.parameters import NodeParameters, Parameter
from cartwheel.bridges.ros2.services import Services
from cartwheel.bridges.ros2.type_descriptions import TYPE as DESCRIPTION
from cartwheel.bridges.ros2.type_descriptions import get_type_description
from cartwheel.bridges.tap import Tap
from cartwheel.codes.wires import (
    BRIDGE_FAULT,
    MALFORMED_MESSAGE,
    MESSAGE_NOT_SENT,
    ROS_NODE_NAME_INVALID,
    TYPE_UNSUPPORTED,
)
from cartwheel.errors import CartwheelError, Diagnostic, GraphError, UnknownNameError
from cartwheel.graph import Service, TopicInfo
from cartwheel.messages import decode_cdr
from cartwheel.messages.ros2.types import is_ros1_only, ros2_service, ros2_type
from cartwheel.reporting import Reporter

READER = "ros2"
"""Node name of the bridge in the graph."""
Rmw = Literal["dds", "zenoh"]
_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*\Z")
_TOLD = 500
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
        self._warn = Reporter(report, _TOLD, title="ROS 2")
        self.name = f"/{node}"
        self._loop = Loop(self._fault, name="ros2")
        self.middleware = _middleware(rmw, self._loop, node, self._warn)
        self._arrivals = Arrivals(graph, self._warn)
        self._log = Log(self._loop, node=node, time_ns=time_ns)
        self._parameters = NodeParameters(self.name, parameters, time_ns=time_ns)
        self._publications: dict[str, _Publication] = {}
        self._subscriptions: dict[str, _Subscription] = {}
        self._services: dict[str, _Offered] = {}
        self._actions: dict[str, OfferedAction] = {}
        self._nodes: dict[str, OwnNode] = {}
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

    def make_way(self, last: str, told: Callable[[frozenset[str]], None]) -> None:
        """Stops publishing topics while other nodes publish them.

        Args:
            last: Last part of the topic names.
            told: Called with these topics whenever they change, on the loop's thread.
        """

        def look() -> None:
            theirs = self.middleware.topics_of_others()
            found = frozenset(one for one in theirs if one.rpartition("/")[2] == last)
            if found != self._theirs:
                self._theirs = found
                self._mirror()
                told(found)

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
        actions = self._graph.actions()
        of_ros1 = {f"{one.name}/{part}" for one in actions for part in _ROS1_PARTS}
        topics = (info for info in self._graph.topics() if info.name not in of_ros1)
        found = survey(topics, known=self._is_known)
        self._mirror_publications(
            {name: info for name, info in found.sent.items() if name not in self._theirs}
        )
        self._mirror_subscriptions(found.read)
        self._mirror_services(
            {one.name: one for one in self._graph.services() if self._is_known_service(one)}
        )
        self._mirror_actions({one.name: one for one in actions})
        self._mirror_nodes()

    def _mirror_nodes(self) -> None:
        """Creates and removes ROS 2 nodes, which exist while they have endpoints."""
        found = {
            *(publication.told[-1] for publication in self._publications.values()),
            *(subscription.told[-1] for subscription in self._subscriptions.values()),
            *(service.told[-1] for service in self._services.values()),
            *(action.node for action in self._actions.values()),
        } - {""}
        for name in self._nodes.keys() - found:
            self._nodes.pop(name).close()
        for name in found - self._nodes.keys():
            self._nodes[name] = OwnNode(self.middleware, self._offers, name)

    def _mirror_publications(self, sent: Mapping[str, TopicInfo]) -> None:
        known = self._publications
        for name, publication in list(known.items()):
            info = sent.get(name)
            if info is None or self._as_told(info) != publication.told:
                known.pop(name).close()
        for name, info in sent.items():
            if name not in known:
                known[name] = _Publication(self, info)

    def _mirror_subscriptions(self, read: Mapping[str, TopicInfo]) -> None:
        known = self._subscriptions
        for name, subscription in list(known.items()):
            if name not in read or self._as_heard(read[name]) != subscription.told:
                known.pop(name).inlet.close()
        for name, info in read.items():
            if name not in known:
                known[name] = _Subscription(self, info)

    def _mirror_services(self, offered: Mapping[str, Service]) -> None:
        known = self._services
        for name, service in list(known.items()):
            one = offered.get(name)
            if one is None or (one.type, self._node_of(one.node)) != service.told:
                known.pop(name).closable.close()
        for name, one in offered.items():
            if name not in known:
                node = self._node_of(one.node)
                known[name] = _Offered(
                    (one.type, node),
                    self._offers.offer(
                        name,
                        one.type,
                        functools.partial(asked, self._graph, name),
                        threaded=True,
                        node=node,
                    ),
                )

    def _mirror_actions(self, offered: Mapping[str, BridgedAction]) -> None:
        known = self._actions
        for name, action in list(known.items()):
            if offered.get(name) is not action.action:
                known.pop(name).close()
        for name, one in offered.items():
            if name not in known:
                known[name] = OfferedAction(
                    self._graph,
                    one,
                    loop=self._loop,
                    middleware=self.middleware,
                    tell=self._warn,
                    node=self._node_of(one.node),
                )

    def _node_of(self, node: str) -> str:
        """ROS 2 node of a node in the graph; empty for the main node."""
        return self._graph.nodes.get(node, "")

    def _as_told(self, info: TopicInfo) -> tuple[str, str, str]:
        """Properties of a published topic that are visible to others: type, QoS, node."""
        return info.type, info.qos, self._node_of(info.publishers[0])

    def _as_heard(self, info: TopicInfo) -> tuple[str, str]:
        """Properties of a subscribed topic that are visible to others: type, node."""
        readers = (name for name in info.subscribers if name not in BRIDGES | ONLOOKERS)
        return info.type, self._node_of(next(readers, ""))

    # -- diagnostics

    def _is_known(self, info: TopicInfo) -> bool:
        if is_ros1_only(info.type):
            return False
        try:
            ros2_type(info.type)
        except UnknownNameError:
            self._warn(
                TYPE_UNSUPPORTED.diagnostic(
                    f"topic {info.name} is not available in ROS 2, which has no type {info.type}",
                    values={"topic": info.name, "type": info.type},
                )
            )
            return False
        return True

    def _is_known_service(self, service: Service) -> bool:
        if is_ros1_only(service.type):
            return False
        try:
            ros2_service(service.type)
        except UnknownNameError:
            self._warn(
                TYPE_UNSUPPORTED.diagnostic(
                    f"service {service.name} is not available in ROS 2, which has no type "
                    f"{service.type}",
                    values={"service": service.name, "type": service.type},
                )
            )
            return False
        return True

    def _fault(self, error: Exception) -> None:
        self._warn(BRIDGE_FAULT.because("unexpected error in the bridge", error))


class _Publication:
    """A topic published from the graph to ROS."""

    def __init__(self, bridge: Ros2Bridge, info: TopicInfo) -> None:
        self.told = bridge._as_told(info)
        """Properties at creation that are visible to others."""
        self._bridge = bridge
        self._name = info.name
        self._faulty = False
        self.tap = Tap(
            bridge._loop,
            bridge._graph,
            topic=info.name,
            type_name=info.type,
            reader=READER,
            ignored=lambda message: message in bridge._arrivals,
            take=self._send,
            tell=bridge._warn,
            beyond=lambda: self._outlet.dropped if self._outlet is not None else 0,
        )
        self._outlet: Outlet | None = None
        self._outlet = bridge.middleware.publish(
            info.name,
            ros2_type(info.type),
            profile_of(info.name, info.qos),
            self._found_readers,
            node=self.told[2],
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

    def __init__(self, bridge: Ros2Bridge, info: TopicInfo) -> None:
        self.type, node = self.told = bridge._as_heard(info)
        """Properties at creation that are visible to others."""
        self._bridge = bridge
        self._name = info.name
        self.inlet = bridge.middleware.subscribe(
            info.name, ros2_type(info.type), DEFAULT, self._take, node=node
        )

    def _take(self, data: bytes) -> None:
        try:
            message = decode_cdr(data, self.type)
        except GraphError as error:
            self._bridge._warn(
                MALFORMED_MESSAGE.because(
                    f"a node sent a malformed message on {self._name}",
                    error,
                    values={"topic": self._name},
                )
            )
            return
        self._bridge._arrivals.deliver(self._name, self.type, message)


class _Offered:
    """An offered service of the graph."""

    def __init__(self, told: tuple[str, str], closable: Closable) -> None:
        self.told = told
        """Type and node of the service, as visible to others."""
        self.closable = closable


def _middleware(rmw: Rmw, loop: Loop, node: str, tell: Callable[[Diagnostic], None]) -> Middleware:
    if rmw == "zenoh":
        from cartwheel.bridges.ros2.zenoh import Zenoh

        return Zenoh(loop, node=node, namespace="/", tell=tell)
    from cartwheel.bridges.ros2.dds import Dds

    return Dds(loop, node=node, namespace="/", tell=tell)
