"""Topics, services and actions within the process, under the naming rules of ROS.

The owner's thread (that of the simulation) publishes and delivers. Other threads subscribe
with a `Mailbox`, and pass messages to the owner with `Graph.post`.
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
from cartwheel.graph.transforms import StaticTransforms
from cartwheel.messages import CdrCache
from cartwheel.messages.library import TypeLibrary

Callback = Callable[[Any], None]
Handler = Callable[[Any], Any]
Qos = Literal["default", "sensor", "latched"]
TWIST = "geometry_msgs/msg/Twist"
TWIST_STAMPED = "geometry_msgs/msg/TwistStamped"


@dataclass(frozen=True, kw_only=True, slots=True)
class TopicInfo:
    """A topic's entry in a listing."""

    name: str
    type: str
    publishers: tuple[str, ...]
    subscribers: tuple[str, ...]
    rate: float | None
    """Publish rate in Hz that the publisher declares. None if it declares none."""
    qos: Qos
    dropped: tuple[int, ...] = ()
    """Number of messages that each subscriber dropped, if the subscriber counts them."""

    @property
    def drives(self) -> bool:
        """Whether the topic has subscribers for velocity commands (`Twist` or `TwistStamped`)."""
        return self.type in (TWIST, TWIST_STAMPED) and bool(self.subscribers)

    @property
    def readers(self) -> tuple[str, ...]:
        """Subscribers, with the number of messages that each dropped."""
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
        """Called with the callback that raised an error, and the error."""
        self.publishers: tuple[Publisher, ...] = ()
        self.subscriptions: tuple[Subscription, ...] = ()
        self.callbacks: tuple[Callback, ...] = ()
        """Callbacks of all subscriptions."""
        self.latched: Any = None

    def deliver(self, message: Any) -> None:
        """Delivers a message to every subscriber. Call it on the owner's thread."""
        for callback in self.callbacks:
            self.hand(callback, message)

    def hand(self, callback: Callback, message: Any) -> None:
        """Calls one callback. Its errors do not reach the publisher."""
        try:
            callback(message)
        except Exception as error:  # noqa: BLE001 - the callback is foreign code
            self.failed(self, callback, error)


class Publisher:
    """Publishes on one topic. Create messages only while `wanted` is true.

    Attributes:
        wanted: Whether the topic has subscribers.
        sent: Number of published messages.
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
        """Delivers a message to all subscribers at once. Call it on the owner's thread."""
        self.sent += 1
        topic = self._topic
        if self.qos == "latched":
            topic.latched = message
        # This is `deliver` inlined, which saves one call per message.
        for callback in topic.callbacks:
            try:
                callback(message)
            except Exception as error:  # noqa: BLE001 - the callback is foreign code
                topic.failed(topic, callback, error)

    def close(self) -> None:
        """Removes the publisher from the graph."""
        self._graph._remove_publisher(self._topic, self)


class Subscription:
    """A callback on a topic, called on the owner's thread."""

    def __init__(self, graph: Graph, topic: Topic, callback: Callback, *, node: str) -> None:
        self._graph = graph
        self._topic = topic
        self.callback = callback
        self.node = node
        self.on_error: OnError | None = None
        """Called with the exception of the callback. None means `Graph.on_error`."""
        self.dropped: Callable[[], int] = lambda: 0
        """Returns the number of messages that a slow subscriber dropped. Callable on any
        thread."""

    @property
    def topic(self) -> str:
        return self._topic.name

    def close(self) -> None:
        """Removes the subscription from the graph."""
        self._graph._remove_subscription(self._topic, self)


OnError = Callable[[Subscription, Exception], None]


@dataclass(frozen=True, kw_only=True, slots=True)
class Service:
    """A service whose `handler` takes a request and returns the response.

    The handler runs on the owner's thread. The handler of a `threaded` service runs on the
    caller's thread: it does slow work, such as reading files, and passes the rest to the owner.
    Use `Graph.call` to call a service.
    """

    name: str
    type: str
    handler: Handler
    node: str
    threaded: bool = False


class Graph:
    """All topics, services and actions of a simulation.

    Args:
        post: Runs a function on the owner's thread soon. The simulation passes its own.
            Without it, functions run at once, for single-threaded use.
        types: Finds message types in packages. None finds only built-in types.
    """

    def __init__(self, post: Post | None = None, *, types: TypeLibrary | None = None) -> None:
        self.post: Post = post or _at_once
        self.post_read: Post | None = None
        """Like `post`, for functions that may also run while the simulation waits, on another
        thread."""
        self.types = types or TypeLibrary()
        self._lock = threading.RLock()
        self._topics: dict[str, Topic] = {}
        self._services: dict[str, Service] = {}
        self._actions: dict[str, Action] = {}
        self._boxes: weakref.WeakSet[Mailbox] = weakref.WeakSet()
        self.parameters = Parameters()
        self.joint_inputs = JointInputs(self._inputs_changed)
        self.cdr = CdrCache()
        """Serialises each message once for all wires."""
        self.nodes: dict[str, str] = {}
        """ROS 2 names of those nodes that appear as separate ROS 2 nodes."""
        self.static_transforms = StaticTransforms(self)
        self.changed: int = 0
        """Incremented on every change of publishers, subscribers or joint inputs, for mirrors of
        the graph."""
        self.on_error: OnError = _raise
        """Called on the owner's thread with the exception of a subscription's callback."""
        self.on_change: list[Callable[[], None]] = []
        """Called after each change that `changed` counts, on any thread, with the graph locked.
        The functions must return at once."""

    def close(self) -> None:
        """Closes all topics, services and actions, and wakes threads that wait for a mailbox.

        Afterwards the graph contains no reference cycles, so its memory is freed with the last
        reference to it.
        """
        with self._lock:
            boxes = list(self._boxes)
            topics = list(self._topics.values())
            self.post = _refuse
            self.post_read = None
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
            self.static_transforms.forget()
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
        """Creates a publisher for a topic of the ROS 2 type ``pkg/msg/Name``.

        Raises:
            GraphError: The topic exists with a different type, or the name or the definition of
                the type is invalid.
        """
        self.types.note(type_name)
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
        anytime: bool = False,
    ) -> Subscription:
        """Calls `callback` with each message on the owner's thread, in the order of publication.

        Args:
            name: Topic.
            callback: Receives each message. It must not change the message.
            type_name: ``pkg/msg/Name``. Required if the topic does not exist yet.
            node: Subscriber's name, for listings.
            anytime: Whether the topic's latched message may also be delivered while the simulation
                waits, on another thread.

        Raises:
            UnknownNameError: The topic does not exist, and no type is given.
            GraphError: The topic has a different type, or the definition of the type is invalid.
        """
        if type_name is not None:
            self.types.note(type_name)
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
                post = self.post_read if anytime and self.post_read else self.post
                post(lambda: topic.hand(callback, latched))
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
        """Creates a bounded queue of messages for a different thread; see `Mailbox`."""
        box = Mailbox(size, can_come=can_come)
        subscription = self.subscribe(name, box.put, type_name=type_name, node=node)
        box.on_close = subscription.close
        with self._lock:
            self._boxes.add(box)
        return box

    def publish(self, name: str, type_name: str, message: Any) -> None:
        """Publishes one message from any thread, by passing it to the owner's thread."""
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
        """Offers a service of type ``pkg/srv/Name``. `Service` describes on which thread it runs.

        Raises:
            GraphError: The name is already in use, or the definition of the type is invalid.
        """
        name = resolve_name(name)
        self.types.note(type_name)
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
        """Removes a service from the graph."""
        with self._lock:
            self._services.pop(service.name, None)
            self._tell_change()

    def offer(self, action: Action) -> None:
        """Registers an action; see `Action`.

        Raises:
            GraphError: The name is already in use, or the definition of the type is invalid.
        """
        self.types.note(action.type)
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
        """Removes an action from the graph."""
        with self._lock:
            if self._actions.get(action.name) is action:
                del self._actions[action.name]
            self._tell_change()

    def actions(self) -> list[Action]:
        """All actions, sorted by name."""
        with self._lock:
            return [self._actions[name] for name in sorted(self._actions)]

    def service(self, name: str) -> Service:
        """Service with this name.

        Raises:
            UnknownNameError: The service does not exist.
        """
        with self._lock:
            if name not in self._services:
                raise UnknownNameError("service", name, self._services, code=SERVICE_UNKNOWN)
            return self._services[name]

    def call(self, name: str, request: Any) -> Future[Any]:
        """Calls a service. Callable on any thread except the owner's, which would deadlock.

        Returns:
            Future of the response, or of the error that the handler raises.

        Raises:
            UnknownNameError: The service does not exist.
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
        """All publishers, sorted by topic."""
        with self._lock:
            return [p for topic in self._live() for p in topic.publishers]

    def services(self) -> list[Service]:
        """All services, sorted by name."""
        with self._lock:
            return [self._services[name] for name in sorted(self._services)]

    def topics(self) -> list[TopicInfo]:
        """All topics with a publisher or a subscriber, sorted by name."""
        with self._lock:
            return [self._info(topic) for topic in self._live()]

    def topic(self, name: str) -> TopicInfo:
        """Topic with this name, if it has a publisher or a subscriber.

        Raises:
            UnknownNameError: No such topic exists.
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
        # The callback unsubscribed before it failed.
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
        # The publishers cache the value, because they check it several times per message.
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
