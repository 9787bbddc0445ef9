"""Topics, services and actions in one process: typed, lazy, as a ROS graph names them.

One thread, the owner (the simulation's), publishes and delivers. Other threads subscribe
with a `Mailbox`, and hand messages in through `Graph.post`.
"""

from __future__ import annotations

import threading
import weakref
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from dataclasses import dataclass
from typing import Any, Literal

from cartwheel.calls import Post, answered
from cartwheel.codes.graph import (
    GRAPH_CLOSED,
    SERVICE_TAKEN,
    SERVICE_TIMED_OUT,
    SERVICE_UNKNOWN,
    TOPIC_TYPE_MISMATCH,
    TOPIC_UNKNOWN,
)
from cartwheel.errors import GraphError, UnknownNameError
from cartwheel.graph.action import Action
from cartwheel.graph.joint_inputs import JointInputs
from cartwheel.graph.mailbox import Mailbox
from cartwheel.graph.names import resolve_name
from cartwheel.graph.parameters import Parameters
from cartwheel.messages import CdrCache

Callback = Callable[[Any], None]
Handler = Callable[[Any], Any]
Qos = Literal["default", "sensor", "latched"]
TWIST = "geometry_msgs/msg/Twist"
TWIST_STAMPED = "geometry_msgs/msg/TwistStamped"


@dataclass(frozen=True, kw_only=True, slots=True)
class TopicInfo:
    """A topic as a listing shows it."""

    name: str
    type: str
    publishers: tuple[str, ...]
    subscribers: tuple[str, ...]
    rate: float | None
    """Hz as stated by its publisher; None where it has none."""
    qos: Qos
    dropped: tuple[int, ...] = ()
    """How many messages each of the subscribers has missed, as far as it counts them."""

    @property
    def drives(self) -> bool:
        """Whether somebody takes velocities there, stamped or not."""
        return self.type in (TWIST, TWIST_STAMPED) and bool(self.subscribers)

    @property
    def readers(self) -> tuple[str, ...]:
        """The subscribers, with what they have missed."""
        dropped = self.dropped or (0,) * len(self.subscribers)
        return tuple(
            f"{name} ({count} dropped)" if count else name
            for name, count in zip(self.subscribers, dropped, strict=True)
        )


class Topic:
    """A named stream of messages of one type."""

    def __init__(
        self, name: str, type_name: str, failed: Callable[[Topic, Callback, Exception], None]
    ) -> None:
        self.name = name
        self.type = type_name
        self.failed = failed
        """Called with the callback that raised an error."""
        self.publishers: tuple[Publisher, ...] = ()
        self.subscriptions: tuple[Subscription, ...] = ()
        self.callbacks: tuple[Callback, ...] = ()
        """Those of the subscriptions."""
        self.latched: Any = None

    def deliver(self, message: Any) -> None:
        """Hands a message to every subscriber; on the owner's thread."""
        for callback in self.callbacks:
            self.hand(callback, message)

    def hand(self, callback: Callback, message: Any) -> None:
        """Calls one of them; its error is not that of who published."""
        try:
            callback(message)
        except Exception as error:  # noqa: BLE001 - another's code
            self.failed(self, callback, error)


class Publisher:
    """The right to publish on a topic. Make a message only when `wanted`.

    Attributes:
        wanted: Whether anybody would read a message published now.
        sent: How many messages were published.
    """

    def __init__(
        self, graph: Graph, topic: Topic, *, node: str, rate: float | None, qos: Qos
    ) -> None:
        self._graph = graph
        self._topic = topic
        self.node = node
        self.rate = rate
        self.qos = qos
        self.wanted = False
        self.sent = 0

    @property
    def topic(self) -> str:
        return self._topic.name

    @property
    def type(self) -> str:
        return self._topic.type

    def publish(self, message: Any) -> None:
        """Delivers to all subscribers at once; on the owner's thread."""
        self.sent += 1
        topic = self._topic
        if self.qos == "latched":
            topic.latched = message
        # `deliver`, a call less for each message.
        for callback in topic.callbacks:
            try:
                callback(message)
            except Exception as error:  # noqa: BLE001 - another's code
                topic.failed(topic, callback, error)

    def close(self) -> None:
        """Takes the publisher off the graph."""
        self._graph._remove_publisher(self._topic, self)


class Subscription:
    """A callback on a topic, called on the owner's thread."""

    def __init__(self, graph: Graph, topic: Topic, callback: Callback, *, node: str) -> None:
        self._graph = graph
        self._topic = topic
        self.callback = callback
        self.node = node
        self.on_error: OnError | None = None
        """Called with what the callback raised; `Graph.on_error` where it is None."""
        self.dropped: Callable[[], int] = lambda: 0
        """Tells, on any thread, how many messages its reader has missed because it was slow."""

    @property
    def topic(self) -> str:
        return self._topic.name

    def close(self) -> None:
        """Takes the subscription off the graph."""
        self._graph._remove_subscription(self._topic, self)


OnError = Callable[[Subscription, Exception], None]


@dataclass(frozen=True, kw_only=True, slots=True)
class Service:
    """A service: `handler` takes a request and returns the response.

    It runs on the owner's thread; one that is `threaded`, on its caller's: it does what takes
    long, such as reading files, and leaves the rest to the owner. Use `Graph.call`.
    """

    name: str
    type: str
    handler: Handler
    node: str
    threaded: bool = False


class Graph:
    """All topics, services and actions of a simulation.

    Args:
        post: Runs a function on the owner's thread, soon; the simulation gives its own.
            Without one, functions run at once, for use on a single thread.
    """

    def __init__(self, post: Post | None = None) -> None:
        self.post: Post = post or _at_once
        self._lock = threading.RLock()
        self._topics: dict[str, Topic] = {}
        self._services: dict[str, Service] = {}
        self._actions: dict[str, Action] = {}
        self._boxes: weakref.WeakSet[Mailbox] = weakref.WeakSet()
        self.parameters = Parameters()
        self.joint_inputs = JointInputs(self._inputs_changed)
        self.cdr = CdrCache()
        """Packs messages for all wires, each once."""
        self.nodes: dict[str, str] = {}
        """ROS 2's names of those nodes of ours that are nodes of their own there."""
        self.static_transforms: Any = None
        """See `StaticTransforms`, which puts itself here."""
        self.changed: int = 0
        """Counts every change of who publishes, subscribes or takes positions, for those who
        mirror the graph."""
        self.on_error: OnError = _raise
        """Called, on the owner's thread, with what a subscription's callback raised."""
        self.on_change: list[Callable[[], None]] = []
        """Called after each such change, on any thread, the graph locked: must return at once."""

    def close(self) -> None:
        """Ends all topics, services and actions; wakes those who wait at a mailbox.

        Nothing of the graph refers to itself afterwards, so its memory is freed with the last
        reference to it.
        """
        with self._lock:
            boxes = list(self._boxes)
            topics = list(self._topics.values())
            self.post = _refuse
            self.on_change.clear()
            self.on_error = _raise
            self.joint_inputs.close()
            for table in (self._topics, self._services, self._actions):
                table.clear()
            for topic in topics:
                topic.publishers = ()
                topic.subscriptions = ()
                topic.callbacks = ()
                topic.latched = None
                topic.failed = _fail
            self.static_transforms = None
        for box in boxes:
            box.close()

    def advertise(
        self,
        name: str,
        type_name: str,
        *,
        node: str = "cartwheel",
        rate: float | None = None,
        qos: Qos = "default",
    ) -> Publisher:
        """A publisher on a topic of the ROS 2 type ``pkg/msg/Name``.

        Raises:
            GraphError: The topic exists with another type, or the name is none.
        """
        with self._lock:
            topic = self._topic(name, type_name)
            publisher = Publisher(self, topic, node=node, rate=rate, qos=qos)
            topic.publishers += (publisher,)
            self._changed(topic)
            return publisher

    def subscribe(
        self,
        name: str,
        callback: Callback,
        *,
        type_name: str | None = None,
        node: str = "cartwheel",
    ) -> Subscription:
        """A callback for each message, on the owner's thread, in order of publication.

        Args:
            name: Topic.
            callback: Takes the message, which must not be changed.
            type_name: ``pkg/msg/Name``; needed where the topic does not exist yet.
            node: Who subscribes, for listings.

        Raises:
            UnknownNameError: No such topic, and no type given.
            GraphError: The topic has another type.
        """
        with self._lock:
            if type_name is None:
                if name not in self._topics:
                    raise UnknownNameError("topic", name, self._topics, code=TOPIC_UNKNOWN)
                type_name = self._topics[name].type
            topic = self._topic(name, type_name)
            subscription = Subscription(self, topic, callback, node=node)
            topic.subscriptions += (subscription,)
            self._changed(topic)
            if (latched := topic.latched) is not None:
                self.post(lambda: topic.hand(callback, latched))
            return subscription

    def mailbox(
        self,
        name: str,
        *,
        size: int = 10,
        type_name: str | None = None,
        node: str = "cartwheel",
        can_come: Callable[[], bool] | None = None,
    ) -> Mailbox:
        """A bounded queue of the topic's messages for another thread to read; see `Mailbox`."""
        box = Mailbox(size, can_come=can_come)
        subscription = self.subscribe(name, box.put, type_name=type_name, node=node)
        box.on_close = subscription.close
        with self._lock:
            self._boxes.add(box)
        return box

    def publish(self, name: str, type_name: str, message: Any) -> None:
        """Delivers one message from any thread: it is handed to the owner."""
        with self._lock:
            topic = self._topic(name, type_name)
        self.post(lambda: topic.deliver(message))

    def serve(
        self,
        name: str,
        type_name: str,
        handler: Handler,
        *,
        node: str = "cartwheel",
        threaded: bool = False,
    ) -> Service:
        """Offers a service of type ``pkg/srv/Name``; see `Service` for the thread it runs on.

        Raises:
            GraphError: The name is taken.
        """
        name = resolve_name(name)
        with self._lock:
            if name in self._services:
                raise GraphError(
                    f'service "{name}" is already offered by {self._services[name].node}',
                    code=SERVICE_TAKEN,
                    values={"name": name, "node": self._services[name].node},
                )
            service = Service(
                name=name, type=type_name, handler=handler, node=node, threaded=threaded
            )
            self._services[service.name] = service
            self._tell_change()
            return service

    def withdraw(self, service: Service) -> None:
        """Takes a service off the graph."""
        with self._lock:
            self._services.pop(service.name, None)
            self._tell_change()

    def offer(self, action: Action) -> None:
        """Puts an action on the graph; see there.

        Raises:
            GraphError: The name is taken.
        """
        with self._lock:
            if action.name in self._actions:
                raise GraphError(
                    f'action "{action.name}" is already offered by '
                    f"{self._actions[action.name].node}",
                    code=SERVICE_TAKEN,
                    values={"name": action.name, "node": self._actions[action.name].node},
                )
            self._actions[action.name] = action
            self._tell_change()

    def take_back(self, action: Action) -> None:
        """Takes an action off the graph."""
        with self._lock:
            if self._actions.get(action.name) is action:
                del self._actions[action.name]
            self._tell_change()

    def actions(self) -> list[Action]:
        """All actions, by name."""
        with self._lock:
            return [self._actions[name] for name in sorted(self._actions)]

    def service(self, name: str) -> Service:
        """The service of that name.

        Raises:
            UnknownNameError: There is none.
        """
        with self._lock:
            if name not in self._services:
                raise UnknownNameError("service", name, self._services, code=SERVICE_UNKNOWN)
            return self._services[name]

    def call(self, name: str, request: Any) -> Future[Any]:
        """Calls a service, from any thread but the owner's, which would wait for itself.

        Returns:
            The response, or the error that the handler raised, as soon as it is there.

        Raises:
            UnknownNameError: There is no such service.
        """
        service = self.service(name)

        def run() -> Any:
            response = service.handler(request)
            if response is None:
                raise GraphError(
                    f'service "{service.name}" returned no response',
                    code=SERVICE_TIMED_OUT,
                    values={"service": service.name},
                )
            return response

        return answered(_at_once if service.threaded else self.post, run)

    def publishers(self) -> list[Publisher]:
        """All publishers, by topic."""
        with self._lock:
            return [p for topic in self._live() for p in topic.publishers]

    def services(self) -> list[Service]:
        """All services, by name."""
        with self._lock:
            return [self._services[name] for name in sorted(self._services)]

    def topics(self) -> list[TopicInfo]:
        """All topics that somebody publishes or reads, by name."""
        with self._lock:
            return [self._info(topic) for topic in self._live()]

    def topic(self, name: str) -> TopicInfo:
        """One topic that somebody publishes or reads.

        Raises:
            UnknownNameError: There is none of that name.
        """
        with self._lock:
            live = {topic.name: topic for topic in self._live()}
            if name not in live:
                raise UnknownNameError("topic", name, live, code=TOPIC_UNKNOWN)
            return self._info(live[name])

    def _live(self) -> Iterator[Topic]:
        for name in sorted(self._topics):
            topic = self._topics[name]
            if topic.publishers or topic.subscriptions:
                yield topic

    @staticmethod
    def _info(topic: Topic) -> TopicInfo:
        return TopicInfo(
            name=topic.name,
            type=topic.type,
            publishers=tuple(publisher.node for publisher in topic.publishers),
            subscribers=tuple(subscription.node for subscription in topic.subscriptions),
            rate=next((p.rate for p in topic.publishers if p.rate), None),
            qos=topic.publishers[0].qos if topic.publishers else "default",
            dropped=tuple(subscription.dropped() for subscription in topic.subscriptions),
        )

    def _topic(self, name: str, type_name: str) -> Topic:
        name = resolve_name(name)
        topic = self._topics.get(name)
        if topic is None or not (
            topic.publishers or topic.subscriptions or topic.type == type_name
        ):
            topic = self._topics[name] = Topic(name, type_name, self._failed)
        elif topic.type != type_name:
            raise GraphError(
                f'topic "{name}" has type {topic.type}, not {type_name}',
                code=TOPIC_TYPE_MISMATCH,
                values={"topic": name, "type": topic.type, "given": type_name},
            )
        return topic

    def _remove_publisher(self, topic: Topic, publisher: Publisher) -> None:
        with self._lock:
            topic.publishers = tuple(p for p in topic.publishers if p is not publisher)
            if not any(p.qos == "latched" for p in topic.publishers):
                topic.latched = None
            self._changed(topic)

    def _remove_subscription(self, topic: Topic, subscription: Subscription) -> None:
        with self._lock:
            topic.subscriptions = tuple(s for s in topic.subscriptions if s is not subscription)
            self._changed(topic)

    def _failed(self, topic: Topic, callback: Callback, error: Exception) -> None:
        for subscription in topic.subscriptions:
            if subscription.callback is callback:
                (subscription.on_error or self.on_error)(subscription, error)
                return
        # It unsubscribed before it failed.
        raise error

    def _inputs_changed(self) -> None:
        with self._lock:
            self._tell_change()

    def _tell_change(self) -> None:
        self.changed += 1
        for callback in self.on_change:
            callback()

    def _changed(self, topic: Topic) -> None:
        topic.callbacks = tuple(subscription.callback for subscription in topic.subscriptions)
        # Told to the publishers, who look several times for each message.
        for publisher in topic.publishers:
            publisher.wanted = bool(topic.subscriptions) or publisher.qos == "latched"
        self._tell_change()


def _at_once(function: Callable[[], None]) -> None:
    function()


def _raise(_: Subscription, error: Exception) -> None:
    raise error


def _fail(_topic: Topic, _callback: Callback, error: Exception) -> None:
    raise error


def _refuse(_: Callable[[], None]) -> None:
    raise GraphError("the simulation is closed", code=GRAPH_CLOSED)
