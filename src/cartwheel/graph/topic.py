"""Topics with their publishers and subscribers, and services."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, Generic, Literal

from cartwheel.calls import Post
from cartwheel.codes.command import OPTIONS_CONFLICT
from cartwheel.codes.graph import FIELD_VALUE_INVALID
from cartwheel.errors import GraphError
from cartwheel.messages import CdrCache, Form, checked, from_dict, from_flat, type_name
from cartwheel.messages.typed import M

if TYPE_CHECKING:
    from cartwheel.graph.graph import Graph

Callback = Callable[[Any], None]
TakeValues = Callable[[Form, tuple[Any, ...]], None]
"""Receives the values of a message instead of the message."""
Filter = Callable[[Any, Callback], None]
"""Receives a message, and a function that passes a message on; see `Interception`."""
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
        self, name: str, type_name: str, failed: Callable[[Topic, Callback, BaseException], None]
    ) -> None:
        self.name = name
        self.type = type_name
        self.failed = failed
        """Called with the callback that raised an error, and the error."""
        self.publishers: tuple[Publisher, ...] = ()
        self.subscriptions: tuple[Subscription, ...] = ()
        self.callbacks: tuple[Callback, ...] = ()
        """Callbacks of all subscriptions."""
        self.takers: tuple[tuple[TakeValues, Callback], ...] = ()
        """The subscriptions' functions that receive values, with the callbacks, if all of them have
        one. Otherwise messages are created."""
        self.filters: tuple[Filter, ...] = ()
        """Functions through which messages pass before they reach the subscribers."""
        self.latched: Any = None
        self.take: Callback | None = None
        """Receives messages from other threads instead of the subscribers; see
        `cartwheel.graph.holding`."""

    def info(self) -> TopicInfo:
        """The topic's entry in a listing."""
        return TopicInfo(
            name=self.name,
            type=self.type,
            publishers=tuple(publisher.node for publisher in self.publishers),
            subscribers=tuple(subscription.node for subscription in self.subscriptions),
            rate=next((p.rate for p in self.publishers if p.rate), None),
            qos=self.publishers[0].qos if self.publishers else "default",
            dropped=tuple(subscription.dropped() for subscription in self.subscriptions),
        )

    def update(self) -> bool:
        """Updates the callbacks and `Publisher.wanted`; returns whether the latter has changed.

        Publishers cache the value, because they check it several times per message.
        """
        self.callbacks = tuple(subscription.callback for subscription in self.subscriptions)
        takers = [(each.take_values, each.callback) for each in self.subscriptions]
        self.takers = tuple((take, callback) for take, callback in takers if take is not None)
        if len(self.takers) != len(takers) or any(p.qos == "latched" for p in self.publishers):
            self.takers = ()
        if self.filters:
            self.callbacks, self.takers = (self._filtered,), ()
        changed = False
        for publisher in self.publishers:
            wanted = bool(self.subscriptions) or publisher.qos == "latched"
            changed = changed or wanted != publisher.wanted
            publisher.wanted = wanted
        return changed

    def forget(self) -> None:
        """Clears all references when the graph is closed."""
        self.publishers, self.subscriptions, self.callbacks = (), (), ()
        self.takers, self.filters = (), ()
        self.latched = self.take = None
        self.failed = _raise

    def deliver(self, message: Any) -> None:
        """Delivers a message to every subscriber. Call it on the owner's thread."""
        # This is `hand` inlined, which saves one call per message.
        for callback in self.callbacks:
            try:
                callback(message)
            except (Exception, SystemExit) as error:  # noqa: BLE001 - the callback is foreign code
                self.failed(self, callback, error)

    def _filtered(self, message: Any) -> None:
        self._pass(self.filters, message)

    def _pass(self, filters: tuple[Filter, ...], message: Any) -> None:
        """Passes a message through filters, and then to every subscriber."""
        if filters:
            filters[0](message, partial(self._pass, filters[1:]))
            return
        for subscription in self.subscriptions:
            self.hand(subscription.callback, message)

    def hand(self, callback: Callback, message: Any) -> None:
        """Calls one callback. Its errors do not reach the publisher."""
        try:
            callback(message)
        except (Exception, SystemExit) as error:  # noqa: BLE001 - the callback is foreign code
            self.failed(self, callback, error)


def arrive(topic: Topic, message: Any, post: Post, cdr: CdrCache) -> None:
    """Passes a message from another thread to the owner's thread, or to `Topic.take`."""
    if topic.take is not None:
        topic.take(message)
    else:
        post(partial(deliver_changed, topic, message, cdr))


def deliver_changed(topic: Topic, message: Any, cdr: CdrCache) -> None:
    """Delivers a message whose fields may have changed since it was last published."""
    cdr.forget()
    topic.deliver(message)


class Publisher(Generic[M]):
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
        """Name of the topic."""
        return self._topic.name

    @property
    def type(self) -> str:
        """Type of the topic, ``pkg/msg/Name``."""
        return self._topic.type

    @property
    def latched(self) -> Any:
        """The message that new subscribers of a latched topic receive; otherwise None."""
        return self._topic.latched if self.qos == "latched" else None

    @latched.setter
    def latched(self, message: Any) -> None:
        if self.qos == "latched":
            self._topic.latched = message

    def publish(self, message: M) -> None:
        """Delivers a message to all subscribers at once. Call it on the owner's thread."""
        self.sent += 1
        topic = self._topic
        if self.qos == "latched":
            topic.latched = message
        # This is `deliver` inlined, which saves one call per message.
        for callback in topic.callbacks:
            try:
                callback(message)
            except (Exception, SystemExit) as error:  # noqa: BLE001 - the callback is foreign code
                topic.failed(topic, callback, error)

    def publish_values(self, form: Form, values: tuple[Any, ...]) -> None:
        """Publishes the message that a form makes of values.

        The message is not created if all subscribers only need its bytes, such as recorders and
        bridges. Call it on the owner's thread, with a new tuple for each message.
        """
        topic = self._topic
        takers = topic.takers
        if takers:
            self.sent += 1
            for take, callback in takers:
                try:
                    take(form, values)
                except (Exception, SystemExit) as error:  # noqa: BLE001 - as in `publish`
                    topic.failed(topic, callback, error)
            return
        # This is `publish` inlined, for the same reason.
        message = form.message(values)
        self.sent += 1
        if self.qos == "latched":
            topic.latched = message
        for callback in topic.callbacks:
            try:
                callback(message)
            except (Exception, SystemExit) as error:  # noqa: BLE001 - as in `publish`
                topic.failed(topic, callback, error)

    def close(self) -> None:
        """Removes the publisher from the graph."""
        self._graph._remove_publisher(self._topic, self)


class CheckedPublisher(Publisher[M]):
    """A publisher for the code of users. It refuses values that are not messages of its type."""

    def publish(self, message: M | Mapping[str, Any] | None = None, **fields: Any) -> None:
        """See `Publisher.publish`.

        Args:
            message: A message, or its fields by name. None: `fields`.
            fields: Fields, where ``linear_x`` is the field ``x`` of ``linear``.

        Raises:
            GraphError: The value is not a message of the topic's type, or a value in it does not
                fit its field.
        """
        made: M = made_message(self.topic, self.type, message, fields)
        # The user may have changed the fields of a message that was published before.
        self._graph.cdr.forget()
        super().publish(made)


def made_message(topic: str, kind: str, message: Any, fields: Mapping[str, Any]) -> Any:
    """The message that a program gives as a message, a mapping or keyword arguments."""
    if fields and message is not None:
        raise GraphError(
            f"a message and single fields are given: {', '.join(sorted(fields))}",
            code=OPTIONS_CONFLICT,
            hint="Pass either a message or its fields.",
            values={"topic": topic, "fields": tuple(sorted(fields))},
        )
    if fields:
        return from_flat(kind, fields, strict=True)
    if message is None or isinstance(message, Mapping):
        return from_dict(kind, message or {}, strict=True)
    return checked_message(topic, kind, message)


def checked_message(topic: str, kind: str, message: Any) -> Any:
    """The message of a program, with the types of its fields; see `cartwheel.messages.checked`.

    Raises:
        GraphError: It is not a message of the topic's type, or a value in it does not fit its
            field.
    """
    given = getattr(type(message), "__msgtype__", type(message).__name__)
    if given not in (kind, type_name(kind)):
        role = "service" if "/srv/" in kind else "action" if "/action/" in kind else "topic"
        raise GraphError(
            f'{role} "{topic}" requires a message of type {kind}, not {given}',
            code=FIELD_VALUE_INVALID,
            values={"topic": topic, "type": kind, "given": given},
            hint="Pass a message, or the values of its fields. The classes of messages are in "
            "cartwheel.msgs.",
        )
    return checked(message)


class Subscription:
    """A callback on a topic, called on the owner's thread."""

    def __init__(
        self,
        graph: Graph,
        topic: Topic,
        callback: Callback,
        *,
        node: str,
        take_values: TakeValues | None = None,
    ) -> None:
        self._graph = graph
        self._topic = topic
        self.callback = callback
        self.take_values = take_values
        self.node = node
        self.on_error: OnError | None = None
        """Called with the exception of the callback. None means `Graph.on_error`."""
        self.dropped: Callable[[], int] = lambda: 0
        """Returns the number of messages that a slow subscriber dropped. Callable on any
        thread."""

    @property
    def topic(self) -> str:
        """Name of the topic."""
        return self._topic.name

    def close(self) -> None:
        """Removes the subscription from the graph."""
        self._graph._remove_subscription(self._topic, self)


OnError = Callable[[Subscription, BaseException], None]


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


def _raise(*call: Any) -> None:
    raise call[-1]
