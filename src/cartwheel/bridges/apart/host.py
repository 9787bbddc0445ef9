"""Access to a graph for a bridge in a different process."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from typing import Any

from cartwheel.bridges.apart.hosted_actions import HostedActions
from cartwheel.bridges.apart.link import Link
from cartwheel.bridges.apart.losses import Losses
from cartwheel.bridges.apart.offers import Offers
from cartwheel.bridges.apart.remote_graph import GraphState
from cartwheel.bridges.apart.ring import Put, RingWriter
from cartwheel.bridges.mirror import Arrivals
from cartwheel.calls import answered, mapped
from cartwheel.codes.wires import MESSAGE_NOT_SENT
from cartwheel.errors import CartwheelError, Diagnostic
from cartwheel.graph import Graph, Service, Subscription
from cartwheel.messages import Form, decode_cdr, encode_cdr, service_classes
from cartwheel.messages.definition import Definition
from cartwheel.messages.learnt import needed
from cartwheel.reporting import Reporter

_MOST_WARNINGS = 500
"""Maximum number of different warnings."""
_CLOCK = "rosgraph_msgs/msg/Clock"
_TIMES, _TIMES_AT_ONCE = 1000.0, 100.0
"""Maximum number of clock messages that are forwarded per s, and in a burst. A simulation at
full speed publishes many more, and every node that uses simulation time would receive them."""
_LAST_TIME = 0.02
"""Delay in s after which the newest delayed clock message is sent."""


class GraphHost:
    """Makes a graph available over a link. The `RemoteGraph` is at the far end.

    Args:
        graph: Graph of the simulation.
        link: Link to the bridge's process.
        ring: Transports messages.
        time_ns: Returns the simulation time. Callable on any thread.
        patient: Whether the simulation waits while the ring is full, instead of dropping messages.
        echo: Whether the bridge receives the messages that it publishes.
        title: Name of the bridge for the user.
        report: Receives diagnostics for the user, on any thread.
    """

    def __init__(
        self,
        graph: Graph,
        link: Link,
        ring: RingWriter,
        *,
        time_ns: Callable[[], int],
        patient: bool,
        echo: bool,
        title: str,
        report: Callable[[Diagnostic], None],
    ) -> None:
        self._graph = graph
        self._link = link
        self._ring = ring
        self._time_ns = time_ns
        self._patient = patient
        self._echo = echo
        self._warn = Reporter(report, _MOST_WARNINGS, title=title)
        self._losses = Losses(ring, self.later, self._warn)
        self._relays: dict[int, _Relay] = {}
        self._arrivals = Arrivals(graph, self._warn)
        self._services: Offers[Service] = Offers()
        self._server = _RemoteServer(link)
        self._actions = HostedActions(link, graph, time_ns)
        self._defined: set[str] = set()
        """Message types whose definitions the bridge has received."""
        self._known: set[str] = set()
        """Topic, service and action types that the bridge has received."""
        self._changing = False
        self._closed = False
        self.waited = 0.0
        """Wall time in s for which the simulation has waited for the bridge."""
        link.handle("begin", self._begin)
        link.handle("taken", lambda: answered(graph.post, lambda: None))
        link.handle("subscribe", self._subscribe)
        link.handle("unsubscribe", self._unsubscribe)
        link.handle("dropped", self._dropped)
        link.handle("publish", self._publish)
        link.handle("call", self._call, threaded=True)
        link.handle("action", self._actions.do)
        link.handle("serve_parameters", self._serve_parameters)
        link.handle("get_parameter", graph.parameters.get, threaded=True)
        link.handle("set_parameter", graph.parameters.set, threaded=True)

    def close(self) -> None:
        """Removes the bridge's subscriptions from the graph. Callable on any thread."""
        self._closed = True
        if self._changed in self._graph.on_change:
            self._graph.on_change.remove(self._changed)
        self._serve_parameters(False)
        for relay in list(self._relays.values()):
            relay.close()
        self._relays.clear()
        self._actions.close()

    # -- on the link's thread

    def _begin(self) -> GraphState:
        self._graph.on_change.append(self._changed)
        return self._state()

    def _changed(self) -> None:
        """Called on any thread, with the graph locked."""
        if not self._changing:
            self._changing = True
            self._link.loop.post(self._tell_change)

    def _tell_change(self) -> None:
        self._changing = False
        if not self._closed:
            self._link.notify("changed", self._state())

    def _state(self) -> GraphState:
        graph = self._graph
        topics = tuple(graph.topics())
        services = self._services.update(graph.services())
        actions = self._actions.update()
        return GraphState(
            time_ns=self._time_ns(),
            topics=topics,
            services=services,
            actions=actions,
            nodes=dict(graph.nodes),
            types=tuple(
                self._new_types(
                    {each.type for each in topics}
                    | {each.type for each in services}
                    | {each.type for each in actions}
                )
            ),
        )

    def _new_types(self, names: set[str]) -> Iterator[Definition]:
        """The definitions that the bridge does not know yet."""
        new = names - self._known
        self._known |= new
        for name in sorted(new):
            for definition in needed(name):
                if definition.name not in self._defined:
                    self._defined.add(definition.name)
                    yield definition

    def _subscribe(self, number: int, name: str, type_name: str, node: str) -> None:
        kind = _Times if type_name == _CLOCK and not self._patient else _Relay
        relay = kind(self, number, name)
        relay.subscription = self._graph.subscribe(
            name,
            relay.take,
            type_name=type_name,
            node=node,
            anytime=True,
            take_values=relay.take_values if kind is _Relay else None,
        )
        relay.subscription.dropped = lambda: relay.dropped + relay.beyond
        self._relays[number] = relay

    def _unsubscribe(self, number: int) -> None:
        relay = self._relays.pop(number, None)
        if relay is not None:
            relay.close()

    def _dropped(self, number: int, count: int) -> None:
        if number in self._relays:
            self._relays[number].beyond = count

    def _publish(self, name: str, type_name: str, data: bytes) -> None:
        message = decode_cdr(data, type_name)
        if self._echo:
            self._graph.publish(name, type_name, message)
        else:
            self._arrivals.deliver(name, type_name, message)

    def _call(self, name: str, data: bytes) -> Future[bytes]:
        """Called on a worker thread."""
        request = service_classes(self._graph.service(name).type)[0]
        future = self._graph.call(name, decode_cdr(data, request.__msgtype__))
        return mapped(future, encode_cdr)

    def _serve_parameters(self, served: bool) -> None:
        parameters = self._graph.parameters
        if served:
            parameters.server = self._server
        elif parameters.server is self._server:
            parameters.server = None

    # -- on the simulation's thread

    def pass_on(self, relay: _Relay, message: Any) -> None:
        """Sends a message of the graph to the bridge, unless the bridge published it."""
        if message in self._arrivals:
            return
        try:
            data = self._graph.cdr.encode(message)
        except Exception as error:  # noqa: BLE001 - rosbags does not catch all errors of its code
            self._refuse(relay, error)
            return
        self._put(relay, data)

    def pass_on_values(self, relay: _Relay, form: Form, values: tuple[Any, ...]) -> None:
        """Sends the message that a form makes of values to the bridge."""
        try:
            data = form.encode(values)
        except CartwheelError as error:
            self._refuse(relay, error)
            return
        self._put(relay, data)

    def _refuse(self, relay: _Relay, error: Exception) -> None:
        self._warn(
            MESSAGE_NOT_SENT.because(
                f"a message on {relay.topic} cannot be sent",
                error,
                values={"topic": relay.topic},
            )
        )

    def _put(self, relay: _Relay, data: bytes) -> None:
        if self._patient:
            put, waited = self._ring.put_patiently(relay.number, self._time_ns(), data)
            self.waited += waited
        else:
            put = self._ring.put(relay.number, self._time_ns(), data)
        if put is not Put.TAKEN and put is not Put.CLOSED:
            relay.dropped += 1
            self._losses.add(relay.topic, put, len(data))

    def later(self, seconds: float, function: Callable[[], None]) -> None:
        """Runs a function on the link's thread after a delay."""
        self._link.loop.post(lambda: self._link.loop.after(seconds, function))


class _Relay:
    """A subscription of the bridge."""

    def __init__(self, host: GraphHost, number: int, topic: str) -> None:
        self._host = host
        self.number = number
        self.topic = topic
        self.subscription: Subscription | None = None
        self.dropped = 0
        self.beyond = 0
        """Number of messages that the bridge dropped."""

    def take(self, message: Any) -> None:
        """Called on the simulation's thread."""
        self._host.pass_on(self, message)

    def take_values(self, form: Form, values: tuple[Any, ...]) -> None:
        """Called on the simulation's thread."""
        self._host.pass_on_values(self, form, values)

    def close(self) -> None:
        """Unsubscribes."""
        if self.subscription is not None:
            self.subscription.close()


class _Times(_Relay):
    """Limits the rate of clock messages. The newest message replaces those not yet sent."""

    def __init__(self, host: GraphHost, number: int, topic: str) -> None:
        super().__init__(host, number, topic)
        self._lock = threading.Lock()
        self._left = _TIMES_AT_ONCE
        self._since = time.monotonic()
        self._held: Any = None
        """The newest message, while the rate limit delays it."""
        self._due = False

    def take(self, message: Any) -> None:
        """Called on the simulation's thread."""
        with self._lock:
            self._held = message
            if self._pass_held() or self._due:
                return
            self._due = True
        self._host.later(_LAST_TIME, self._pass_last)

    def _pass_held(self) -> bool:
        now = time.monotonic()
        self._left = min(_TIMES_AT_ONCE, self._left + (now - self._since) * _TIMES)
        self._since = now
        if self._held is None or self._left < 1.0:
            return self._held is None
        self._left -= 1.0
        message, self._held = self._held, None
        self._host.pass_on(self, message)
        return True

    def _pass_last(self) -> None:
        """Sends the delayed message on the link's thread, as no later message may follow."""
        with self._lock:
            self._due = not self._pass_held()
        if self._due:
            self._host.later(_LAST_TIME, self._pass_last)


class _RemoteServer:
    """Parameters that the bridge stores; a `ParameterServer`."""

    def __init__(self, link: Link) -> None:
        self._link = link

    def get(self, name: str) -> Any:
        """Returns the value, after waiting for the response."""
        return self._link.ask("server_get", name)

    def set(self, name: str, value: Any) -> None:
        """Stores a value."""
        self._link.notify("server_set", name, _plain(value))


def _plain(value: Any) -> Any:
    return value.tolist() if hasattr(value, "tolist") else value
