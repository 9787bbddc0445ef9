"""The graph of a simulation as a ROS 1 node."""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

from cartwheel.bridges.bridged import BridgedGraph
from cartwheel.bridges.loop import Loop
from cartwheel.bridges.mirror import Arrivals, asked, is_available, survey
from cartwheel.bridges.ros1.address import (
    bind_address,
    host_and_port,
    is_local,
    master_uri,
    own_host,
)
from cartwheel.bridges.ros1.core import OwnCore
from cartwheel.bridges.ros1.log import Log
from cartwheel.bridges.ros1.master import MasterParameters
from cartwheel.bridges.ros1.names import Arguments, NodeNames
from cartwheel.bridges.ros1.node import Node
from cartwheel.bridges.ros1.publication import GraphPublication
from cartwheel.bridges.ros1.registrar import Entry, Registrar
from cartwheel.bridges.ros1.rpc import Peer, RpcError, UnreachableError
from cartwheel.bridges.ros1.service import Answer, OfferedService
from cartwheel.bridges.ros1.subscription import TopicSubscription
from cartwheel.codes.wires import (
    BRIDGE_FAULT,
    ROS_MASTER_BACK,
    ROS_MASTER_LOST,
    ROS_MASTER_UNAVAILABLE,
    ROS_NODE_ENDED,
)
from cartwheel.errors import CartwheelError, Diagnostic
from cartwheel.graph import Service, TopicInfo
from cartwheel.messages.ros1 import ros1_service, ros1_type
from cartwheel.messages.store import is_ros2_only
from cartwheel.reporting import Reporter

READER = "ros1"
"""Node name of the bridge in the graph."""
_FIRST_ANSWER = 3.0
"""Timeout in s for the master's response at startup."""
_MOST_WARNINGS = 500
"""Maximum number of different warnings. They contain node names, whose number is not limited."""
_LONGEST = 1000
"""Maximum length of a warning in characters."""

Report = Callable[[Diagnostic], None]


class Ros1Bridge:
    """Connects the topics, services and parameters of a graph to ROS 1, as a node.

    The bridge subscribes to the graph only while a node is connected. It implements the protocols
    itself (TCPROS, the XML-RPC interfaces), so ROS need not be installed. If no master responds,
    it starts ROS's own master.

    Args:
        graph: Graph of the simulation.
        node: Name of the node, unless ``__name:=`` overrides it.
        arguments: ``name:=value`` arguments, as for any ROS node.
        report: Receives diagnostics for the user, on any thread.
        time_ns: Returns the simulation time, for timestamps on ``/rosout``.
        on_end: Called on a separate thread with the reason when a node or user has shut down this
            node.

    Raises:
        CartwheelError: A name or URI is invalid.
    """

    def __init__(
        self,
        graph: BridgedGraph,
        *,
        node: str = "gazebo",
        arguments: Sequence[str] = (),
        report: Report = lambda _: None,
        time_ns: Callable[[], int] = lambda: 0,
        on_end: Report = lambda _: None,
    ) -> None:
        self._graph = graph
        self._on_end = on_end
        self._arguments = Arguments.parse(arguments)
        self._names = NodeNames(node, self._arguments)
        self.master_uri = master_uri(self._arguments.special)
        self._host = host = own_host(self._arguments.special, self.master_uri)
        self._core: OwnCore | None = None
        self._reporter = Reporter(report, _MOST_WARNINGS, title="ROS")
        self._closed = False
        self._arrivals = Arrivals(graph, self._warn)
        self._loop = Loop(self._fault, name="ros1")
        self._node = Node(
            self._loop,
            name=self._names.node,
            host=host,
            address=bind_address(host),
            master_uri=self.master_uri,
            on_shutdown=self._shut_down,
            warn=self._warn,
        )
        self._log = Log(self._loop, node=self.name, time_ns=time_ns, warn=self._warn)
        self._parameters = MasterParameters(
            self.master_uri, node=self.name, outer=self._names.parameter, wake=self._wake
        )
        self._registrar = Registrar(
            master_uri=self.master_uri,
            node=self.name,
            uri=self._node.uri,
            service_uri=self._node.service_uri,
            parameters=self._parameters,
            survey=self._survey,
            on_publishers=self._found_publishers,
            on_lost=self._lost_master,
            on_found=self._found_master,
            on_taken=self._taken,
            on_fault=self._fault,
        )
        self._lost = False
        self._losses = 0

    @property
    def name(self) -> str:
        """Full name of the node, with namespace."""
        return self._names.node

    @property
    def has_own_master(self) -> bool:
        """Whether this node started the master, and will stop it."""
        return self._core is not None

    @property
    def open_ports(self) -> tuple[int, ...]:
        """Ports that other computers can reach; none if the own host is loopback, as in rospy."""
        if bind_address(self._host):
            return ()
        own = (host_and_port(self.master_uri)[1],) if self._core is not None else ()
        return (*own, *self._node.ports)

    @property
    def uri(self) -> str:
        """URI of the node's XML-RPC interface."""
        return self._node.uri

    def start(self) -> None:
        """Connects to the master, or starts one. The rest follows on other threads.

        Raises:
            CartwheelError: No master is running, and none can be started.
        """
        self._join()
        self._graph.parameters.server = self._parameters
        for name, value in self._arguments.parameters.items():
            self._parameters.set(self._names.private(name), value)
        self._use_sim_time()
        self._loop.start()
        self._graph.on_change.append(self._registrar.wake)
        self._registrar.start()

    def log(self, diagnostic: Diagnostic) -> None:
        """Logs a diagnostic on ``/rosout``. Callable on any thread."""
        self._log.write(diagnostic)

    def close(self) -> None:
        """Unregisters from the master and disconnects from all nodes. Returns at once."""
        if self._closed:
            return
        self._closed = True
        if self._registrar.wake in self._graph.on_change:
            self._graph.on_change.remove(self._registrar.wake)
        if self._graph.parameters.server is self._parameters:
            self._graph.parameters.server = None
        self._registrar.stop()
        self._loop.post(self._node.close)
        self._loop.stop()
        if self._core is not None:
            self._core.stop()

    # -- the master

    def _join(self) -> None:
        try:
            Peer(self.master_uri, timeout=_FIRST_ANSWER).call("getPid", self.name)
        except UnreachableError as error:
            host, _ = host_and_port(self.master_uri)
            if not is_local(host) or error.silent:
                raise CartwheelError(
                    f"the ROS master does not respond: {error.message}",
                    code=ROS_MASTER_UNAVAILABLE,
                    hint="Another program, or a roscore that hangs, is listening on its port."
                    if is_local(host)
                    else "ROS_MASTER_URI refers to a different computer. Check that roscore is "
                    "running there.",
                    values={"uri": self.master_uri},
                ) from None
            self._core = OwnCore(self.master_uri, self._host)
            self._core.start()
        except RpcError as error:
            raise CartwheelError(
                f"{self.master_uri} is not a ROS master: {error.message}",
                code=ROS_MASTER_UNAVAILABLE,
                values={"uri": self.master_uri},
            ) from None

    def _use_sim_time(self) -> None:
        if self._parameters.get("/use_sim_time") is None:
            self._parameters.set("/use_sim_time", True)

    def _lost_master(self, reason: str) -> None:
        if not self._lost:
            self._lost = True
            self._losses += 1
            self._warn(
                ROS_MASTER_LOST.diagnostic(
                    f"the ROS master no longer responds: {reason}",
                    hint="The simulation continues, and registers again when a master responds at "
                    "this address.",
                    values={"uri": self.master_uri, "reason": reason, "losses": self._losses},
                )
            )
        if self._core is not None and self._core.dead and not self._closed:
            try:
                self._core.start()
            except CartwheelError as error:
                self._warn(error.diagnostic("warning"))

    def _found_master(self) -> None:
        self._lost = False
        self._warn(
            ROS_MASTER_BACK.diagnostic(
                "the ROS master is reachable again; topics and services have been registered",
                values={"uri": self.master_uri, "losses": self._losses},
            )
        )

    def _taken(self, uri: str) -> None:
        self._finish(
            ROS_NODE_ENDED.diagnostic(
                f"another ROS node registered with the name {self.name}: {uri}",
                values={"node": self.name, "uri": uri},
            )
        )

    def _shut_down(self, reason: str) -> None:
        self._finish(
            ROS_NODE_ENDED.diagnostic(
                f"ROS shut down the node {self.name}: {reason or 'no reason given'}",
                values={"node": self.name, "reason": reason},
            )
        )

    def _finish(self, diagnostic: Diagnostic) -> None:
        if not self._closed:
            self._on_end(_printable(diagnostic))

    def _wake(self) -> None:
        self._registrar.wake()

    # -- the graph

    def _survey(self) -> list[Entry]:
        """Makes the node offer what the graph offers. Called on the registrar's thread."""
        topics, services = self._graph.topics(), self._graph.services()
        return self._loop.call(lambda: self._mirror(topics, services)).result()

    def _mirror(self, topics: Sequence[TopicInfo], services: Sequence[Service]) -> list[Entry]:
        node, outer = self._node, self._names.outer
        found = survey(
            topics, outer=outer, known=lambda info: self._is_known("topic", info, ros1_type)
        )
        node.publications.setdefault(self._log.publication.topic, self._log.publication)
        node.publications.synchronise(
            {name: info.type for name, info in found.sent.items()},
            lambda name, _: self._publication(name, found.sent[name]),
        )
        for name in node.publications.properties:
            node.publications[name].latched = found.sent[name].qos == "latched"
        node.subscriptions.synchronise(
            {name: info.type for name, info in found.read.items()},
            lambda name, _: self._subscription(name, found.read[name]),
        )
        private, log = self._names.private, self._log
        calls: dict[str, tuple[str, Answer]] = {
            outer(one.name): (one.type, functools.partial(asked, self._graph, one.name))
            for one in services
            if self._is_known("service", one, ros1_service)
        } | {
            private("get_loggers"): ("roscpp/GetLoggers", log.get_loggers),
            private("set_logger_level"): ("roscpp/SetLoggerLevel", log.set_logger_level),
        }
        node.services.synchronise(
            {name: ros1_service(type_name) for name, (type_name, _) in calls.items()},
            lambda name, type_: OfferedService(
                self._loop,
                node.calls,
                name=name,
                type_=type_,
                answer=calls[name][1],
                node=self.name,
            ),
        )
        return [
            *(Entry("Publisher", name, one.type.name) for name, one in node.publications.items()),
            *(Entry("Subscriber", name, one.type.name) for name, one in node.subscriptions.items()),
            *(Entry("Service", name, one.type.name) for name, one in node.services.items()),
        ]

    def _publication(self, name: str, info: TopicInfo) -> GraphPublication:
        return GraphPublication(
            self._loop,
            self._graph,
            source=info.name,
            type_name=info.type,
            reader=READER,
            ignored=lambda message: message in self._arrivals,
            topic=name,
            type_=ros1_type(info.type),
            latched=info.qos == "latched",
            node=self.name,
            warn=self._warn,
        )

    def _subscription(self, name: str, info: TopicInfo) -> TopicSubscription:
        return TopicSubscription(
            self._loop,
            self._node.traffic,
            self._node.attempts,
            topic=name,
            type_name=info.type,
            type_=ros1_type(info.type),
            node=self.name,
            own_uri=self._node.uri,
            deliver=self._deliverer(info.name, info.type),
            warn=self._warn,
        )

    def _deliverer(self, topic: str, type_name: str) -> Callable[[Any, int], None]:
        return lambda message, size: self._arrivals.deliver(topic, type_name, message, size=size)

    def _found_publishers(self, topic: str, uris: list[str]) -> None:
        def update() -> None:
            subscription = self._node.subscriptions.get(topic)
            if subscription is not None:
                # A master that has just started does not know the node's existing connections.
                subscription.update(uris, drop=False)

        self._loop.post(update)

    # -- diagnostics

    def _is_known(self, kind: str, one: TopicInfo | Service, find: Callable[[str], object]) -> bool:
        return not is_ros2_only(one.type) and is_available(
            kind, one.name, one.type, ros="ROS 1", find=find, warn=self._warn
        )

    def _warn(self, diagnostic: Diagnostic) -> None:
        """Reports a warning once, with unprintable characters replaced."""
        diagnostic = _printable(diagnostic)
        is_note = diagnostic.severity == "info"
        (self._reporter.always if is_note else self._reporter)(diagnostic)

    def _fault(self, error: Exception) -> None:
        self._warn(BRIDGE_FAULT.because("unexpected error in the bridge", error))


def _printable(diagnostic: Diagnostic) -> Diagnostic:
    def cleaned(text: str) -> str:
        return "".join(c if c.isprintable() else "?" for c in text[:_LONGEST])

    return replace(diagnostic, message=cleaned(diagnostic.message), hint=cleaned(diagnostic.hint))
