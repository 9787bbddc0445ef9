"""Topics, services and actions within the process, under the naming rules of ROS.

The owner's thread (that of the simulation) publishes and delivers. Other threads subscribe
with a `Mailbox`, and pass messages to the owner with `Graph.post`. The file is long because
one lock protects all tables.
"""

from __future__ import annotations

import threading
import weakref
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from typing import Any

from cartwheel.calls import Post, answered
from cartwheel.codes.graph import (
    ACTION_UNKNOWN,
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
from cartwheel.graph.names import absolute_name, resolve_name
from cartwheel.graph.parameters import Parameters
from cartwheel.graph.topic import (
    Callback,
    CheckedPublisher,
    Filter,
    Handler,
    OnError,
    Publisher,
    Qos,
    Service,
    Subscription,
    TakeValues,
    Topic,
    TopicInfo,
    arrive,
)
from cartwheel.graph.transforms import StaticTransforms
from cartwheel.messages import CdrCache
from cartwheel.messages.library.library import TypeLibrary


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
        self.on_demand: Callable[[], None] = lambda: None
        """Called when `wanted` of a publisher changes; otherwise like a function of `on_change`."""
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
            self.on_demand = lambda: None
            self.on_error = _raise
            self.joint_inputs.close()
            for table in (self._topics, self._services, self._actions):
                table.clear()
            for topic in topics:
                topic.forget()
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
        checked: bool = False,
    ) -> Publisher:
        """Creates a publisher for a topic of the ROS 2 type ``pkg/msg/Name``.

        Args:
            name: Topic.
            type_name: Message type.
            node: Publisher's name, for listings.
            rate: Publish rate for listings, Hz.
            qos: Quality of service on ROS 2.
            checked: Whether the publisher refuses values that are not messages of its type.

        Raises:
            GraphError: The topic exists with a different type, or the name or the definition of
                the type is invalid.
        """
        self.types.note(type_name)
        with self._lock:
            topic = self._topic(name, type_name)
            kind = CheckedPublisher if checked else Publisher
            publisher = kind(self, topic, node=node, rate=rate, qos=qos)
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
        take_values: TakeValues | None = None,
    ) -> Subscription:
        """Calls `callback` with each message on the owner's thread, in the order of publication.

        Args:
            name: Topic.
            callback: Receives each message. It must not change the message.
            type_name: ``pkg/msg/Name``. Required if the topic does not exist yet.
            node: Subscriber's name, for listings.
            anytime: Whether the topic's latched message may also be delivered while the simulation
                waits, on another thread.
            take_values: Receives the form and the values of a message instead of the message, if
                all subscribers of the topic have such a function; see `Publisher.publish_values`.

        Raises:
            UnknownNameError: The topic does not exist, and no type is given.
            GraphError: The topic has a different type, or the definition of the type is invalid.
        """
        if type_name is not None:
            self.types.note(type_name)
        with self._lock:
            if type_name is None:
                known = self._topics.get(absolute_name(name))
                if known is None:
                    raise UnknownNameError("topic", name, self._topics, code=TOPIC_UNKNOWN)
                type_name = known.type
            topic = self._topic(name, type_name)
            subscription = Subscription(self, topic, callback, node=node, take_values=take_values)
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
            topic = self._topics.get(name)
            if topic is None or topic.type != type_name:
                topic = self._topic(name, type_name)
        arrive(topic, message, self.post, self.cdr)

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
            self._notify()
            return service

    def withdraw(self, service: Service) -> None:
        """Removes a service from the graph."""
        with self._lock:
            self._services.pop(service.name, None)
            self._notify()

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
            self._notify()

    def take_back(self, action: Action) -> None:
        """Removes an action from the graph."""
        with self._lock:
            if self._actions.get(action.name) is action:
                del self._actions[action.name]
            self._notify()

    def abort_goals(self) -> None:
        """Ends the goals of a time before a reset that their servers have not ended."""
        for action in self.actions():
            action.abort("the world was reset")

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
            service = self._services.get(absolute_name(name))
            if service is None:
                raise UnknownNameError("service", name, self._services, code=SERVICE_UNKNOWN)
            return service

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
            return [topic.info() for topic in self._live()]

    def topic(self, name: str) -> TopicInfo:
        """Topic with this name, if it has a publisher or a subscriber.

        Raises:
            UnknownNameError: No such topic exists.
        """
        with self._lock:
            topic = self._topics.get(absolute_name(name))
            if topic is None or not (topic.publishers or topic.subscriptions):
                live = [each.name for each in self._live()]
                raise UnknownNameError("topic", name, live, code=TOPIC_UNKNOWN)
            return topic.info()

    def subscriptions(self, node: str) -> tuple[Subscription, ...]:
        """The subscriptions of a node, by the names of their topics."""
        with self._lock:
            return tuple(
                each for topic in self._live() for each in topic.subscriptions if each.node == node
            )

    def set_filters(
        self, name: str, change: Callable[[tuple[Filter, ...]], tuple[Filter, ...]]
    ) -> None:
        """Changes the functions through which the messages of a topic pass; see `Interception`."""
        with self._lock:
            topic = self._topics.get(name)
            if topic is not None:
                topic.filters = change(topic.filters)
                self._changed(topic)

    def is_disturbed(self, name: str) -> bool:
        """Whether messages of a topic pass through functions, such as those of a fault."""
        with self._lock:
            topic = self._topics.get(resolve_name(name))
            return topic is not None and bool(topic.filters)

    def latched(self, name: str) -> Any:
        """The message that a latched topic delivers to new subscribers; None if there is none."""
        with self._lock:
            topic = self._topics.get(resolve_name(name))
            return None if topic is None else topic.latched

    def action(self, name: str) -> Action:
        """Action with this name.

        Raises:
            UnknownNameError: The action does not exist.
        """
        with self._lock:
            action = self._actions.get(absolute_name(name))
            if action is None:
                raise UnknownNameError("action", name, self._actions, code=ACTION_UNKNOWN)
            return action

    def _live(self) -> Iterator[Topic]:
        """The topics with a publisher or a subscriber, sorted by name."""
        for name in sorted(self._topics):
            topic = self._topics[name]
            if topic.publishers or topic.subscriptions:
                yield topic

    def _topic(self, name: str, type_name: str) -> Topic:
        """The topic with a name, created if it is unused; see `advertise` for the errors."""
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

    def _failed(self, topic: Topic, callback: Callback, error: BaseException) -> None:
        for subscription in topic.subscriptions:
            if subscription.callback is callback:
                (subscription.on_error or self.on_error)(subscription, error)
                return
        # The callback unsubscribed before it failed.
        raise error

    def _inputs_changed(self) -> None:
        with self._lock:
            self._notify()

    def _notify(self) -> None:
        self.changed += 1
        for callback in self.on_change:
            callback()

    def _changed(self, topic: Topic) -> None:
        if topic.update():
            self.on_demand()
        self._notify()


def _at_once(function: Callable[[], None]) -> None:
    function()


def _raise(*call: Any) -> None:
    raise call[-1]


def _refuse(_: Callable[[], None]) -> None:
    raise GraphError("the simulation is closed", code=GRAPH_CLOSED)
