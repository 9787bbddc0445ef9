"""Graph of a simulation in a different process, as its bridge sees it."""

from __future__ import annotations

import itertools
import queue
import threading
from collections.abc import Callable, Mapping
from concurrent.futures import Future
from dataclasses import dataclass
from typing import Any, TypeVar

from cartwheel.bridges.apart.link import Link
from cartwheel.bridges.apart.offers import Offer
from cartwheel.bridges.apart.remote_action import RemoteAction
from cartwheel.bridges.packed import Packed
from cartwheel.calls import answered, mapped
from cartwheel.codes.graph import SERVICE_UNKNOWN, TOPIC_UNKNOWN
from cartwheel.errors import UnknownNameError
from cartwheel.graph import ParameterServer, Service, TakeValues, TopicInfo
from cartwheel.messages import decode_cdr, encode_cdr, service_classes
from cartwheel.messages.definition import Definition
from cartwheel.messages.learnt import register

T = TypeVar("T")
_LOOKS = 0.25
"""Interval in s at which dropped messages and feedback requests are checked."""


@dataclass(frozen=True, kw_only=True, slots=True)
class GraphState:
    """State of a graph, sent on each change."""

    time_ns: int
    topics: tuple[TopicInfo, ...] = ()
    services: tuple[Offer, ...] = ()
    actions: tuple[Offer, ...] = ()
    nodes: Mapping[str, str]
    types: tuple[Definition, ...] = ()
    """Message types that this process does not know yet, nested ones first."""


class _Packer:
    """Returns the original bytes of messages that the other process packed."""

    def encode(self, message: Any) -> bytes:
        if isinstance(message, Packed):
            return message.cdr
        return encode_cdr(message)


class RemoteSubscription:
    """A subscription; see `Subscription`."""

    def __init__(
        self, graph: RemoteGraph, number: int, type_name: str, callback: Callable[[Any], None]
    ) -> None:
        self._graph = graph
        self.number = number
        self.type = type_name
        self.callback = callback
        self.dropped: Callable[[], int] = lambda: 0
        self.reported = 0
        """Value of `dropped` that was last sent to the other process."""

    def close(self) -> None:
        """Unsubscribes."""
        self._graph._remove(self)


class RemoteParameters:
    """The graph's parameters; see `Parameters`."""

    def __init__(self, link: Link) -> None:
        self._link = link
        self._server: ParameterServer | None = None
        self._answering: ParameterServer | None = None
        """The last server. The other process may still call it after it was replaced."""
        link.handle("server_get", lambda name: self._kept().get(name), threaded=True)
        link.handle("server_set", lambda name, value: self._kept().set(name, value))

    @property
    def server(self) -> ParameterServer | None:
        """Parameter server, if this process provides it."""
        return self._server

    @server.setter
    def server(self, server: ParameterServer | None) -> None:
        self._server = server
        self._answering = server or self._answering
        if server is None:
            # Use `notify`, because the other process may already have exited.
            self._link.notify("serve_parameters", False)
        else:
            self._link.ask("serve_parameters", True)

    def get(self, name: str, default: Any = None) -> Any:
        """Returns a value, after waiting for the response."""
        return self._link.ask("get_parameter", name, default)

    def set(self, name: str, value: Any) -> None:
        """Stores a value."""
        self._link.ask("set_parameter", name, value)

    def _kept(self) -> ParameterServer:
        assert self._answering is not None
        return self._answering


class RemoteGraph:
    """A `BridgedGraph`. Its methods wait for responses, but not for simulation steps.

    Messages are delivered as `Packed` on one thread. Posted functions run on a second thread.

    Args:
        link: Link to the simulation's process.
        on_fault: Called with the exceptions of callbacks.
    """

    def __init__(self, link: Link, *, on_fault: Callable[[Exception], None]) -> None:
        self._link = link
        self._on_fault = on_fault
        self._state = GraphState(time_ns=0, nodes={})
        self._services: dict[int, Service] = {}
        self._actions: dict[int, RemoteAction] = {}
        self._subscriptions: dict[int, RemoteSubscription] = {}
        self._numbers = itertools.count(1)
        self._posted: queue.SimpleQueue[Callable[[], None]] = queue.SimpleQueue()
        self.time_ns = 0
        """Latest known simulation time."""
        self.parameters = RemoteParameters(link)
        self.cdr = _Packer()
        self.on_change: list[Callable[[], None]] = []
        link.handle("changed", self._changed)
        link.handle("goal", self._goal_event)
        threading.Thread(target=self._run_posted, name="graph", daemon=True).start()

    def begin(self) -> None:
        """Fetches the state of the graph."""
        self._changed(self._link.ask("begin"))
        self._link.loop.post(self._look)

    # -- interface of a graph

    @property
    def nodes(self) -> Mapping[str, str]:
        """See `Graph.nodes`."""
        return self._state.nodes

    def topics(self) -> list[TopicInfo]:
        """All topics, sorted by name."""
        return list(self._state.topics)

    def services(self) -> list[Service]:
        """All services, sorted by name. Only `call` can call them."""
        return list(self._services.values())

    def actions(self) -> list[RemoteAction]:
        """All actions, sorted by name."""
        return list(self._actions.values())

    def post(self, function: Callable[[], None]) -> None:
        """Runs a function after the simulation has processed all previous messages and calls."""
        future = self._link.call("taken")
        future.add_done_callback(lambda _: self._posted.put(function))

    def run(self, function: Callable[[], T]) -> Future[T]:
        """Runs a function on the thread of posted functions."""
        return answered(self._posted.put, function)

    def subscribe(
        self,
        name: str,
        callback: Callable[[Any], None],
        *,
        type_name: str | None = None,
        node: str = "cartwheel",
        take_values: TakeValues | None = None,  # noqa: ARG002 - messages arrive as bytes
    ) -> RemoteSubscription:
        """Calls `callback` with each message, on the thread that reads messages.

        Raises:
            CartwheelError: See `Graph.subscribe`.
        """
        if type_name is None:
            known = {info.name: info.type for info in self._state.topics}
            if name not in known:
                raise UnknownNameError("topic", name, known, code=TOPIC_UNKNOWN)
            type_name = known[name]
        made = RemoteSubscription(self, next(self._numbers), type_name, callback)
        # This must be set before the first message arrives.
        self._subscriptions[made.number] = made
        try:
            self._link.ask("subscribe", made.number, name, type_name, node)
        except Exception:
            del self._subscriptions[made.number]
            raise
        return made

    def publish(self, name: str, type_name: str, message: Any) -> None:
        """Publishes one message."""
        self._link.notify("publish", name, type_name, encode_cdr(message))

    def call(self, name: str, request: Any) -> Future[Any]:
        """Calls a service.

        Raises:
            UnknownNameError: The service does not exist.
        """
        types = {one.name: one.type for one in self._state.services}
        if name not in types:
            raise UnknownNameError("service", name, types, code=SERVICE_UNKNOWN)
        response = service_classes(types[name])[1].__msgtype__
        answer = self._link.call("call", name, encode_cdr(request))
        return mapped(answer, lambda data: decode_cdr(data, response))

    # -- incoming messages and changes

    def take(self, number: int, time_ns: int, data: bytes) -> None:
        """Handles a message on the thread that reads messages."""
        self.time_ns = time_ns
        found = self._subscriptions.get(number)
        if found is not None:
            found.callback(Packed(data, found.type))

    def _changed(self, state: GraphState) -> None:
        self.time_ns = state.time_ns
        register(state.types)
        services, actions = self._services, self._actions
        # Existing services stay the same objects, because mirrors of the graph compare them.
        self._services = {
            one.number: services.get(one.number)
            or Service(name=one.name, type=one.type, handler=_elsewhere, node=one.node)
            for one in state.services
        }
        self._actions = {
            one.number: actions.get(one.number) or RemoteAction(self._link, one, self)
            for one in state.actions
        }
        self._state = state
        for callback in list(self.on_change):
            callback()

    def _goal_event(self, number: int, goal: Any, feedback: bytes | None) -> None:
        action = self._actions.get(number)
        if action is not None:
            self._posted.put(lambda: action.hear(goal, feedback))

    def _run_posted(self) -> None:
        while True:
            function = self._posted.get()
            try:
                function()
            except Exception as error:  # noqa: BLE001 - one error must not stop the others
                self._on_fault(error)

    def _remove(self, subscription: RemoteSubscription) -> None:
        if self._subscriptions.pop(subscription.number, None) is not None:
            self._link.notify("unsubscribe", subscription.number)

    def _look(self) -> None:
        for one in list(self._subscriptions.values()):
            count = one.dropped()
            if count != one.reported:
                one.reported = count
                self._link.notify("dropped", one.number, count)
        for action in list(self._actions.values()):
            action.tell_wants()
        self._link.loop.after(_LOOKS, self._look)


def _elsewhere(_: Any) -> Any:
    raise NotImplementedError(
        "a service in a different process must be called through the graph of that process"
    )
