"""Topics, services and actions of a model."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, cast, overload

from cartwheel.api.arguments import several, text
from cartwheel.api.handles import Handle
from cartwheel.api.timing import TIMEOUT
from cartwheel.api.values import Moment
from cartwheel.graph import Mailbox, Subscription, resolve_frame, resolve_name
from cartwheel.messages.typed import Kind, M

if TYPE_CHECKING:
    from cartwheel.api.calling import Goal
    from cartwheel.api.exchange.actions import ActionServer, ReceivedGoal
    from cartwheel.api.exchange.faults import Fault
    from cartwheel.api.exchange.serving import ServiceServer
    from cartwheel.api.links import Link
    from cartwheel.api.topics import Topic
    from cartwheel.api.world import World
    from cartwheel.geometry import Pose


class MessagingModel(Handle):
    """The part of `Model` that exchanges messages.

    Its methods are those of `World`, where a name without a leading ``/`` is in the namespace of
    the model.
    """

    __slots__ = ()
    _world: World
    name: str

    @property
    def namespace(self) -> str:
        """Namespace of the model's topics and services, with a leading ``/``."""
        with self._world.lock:
            return "/" + self._world.session.simulation.namespace(self.name).strip("/")

    @property
    def topics(self) -> tuple[str, ...]:
        """Names of the topics of the model's devices and plugins, sorted."""
        with self._world.lock:
            own = self._world.session.simulation.topics(self.name)
            return tuple(name for name in self._world.topics if name in own)

    @property
    def services(self) -> tuple[str, ...]:
        """Names of the services of the model's devices and plugins, sorted."""
        with self._world.lock:
            own = self._world.session.simulation.services(self.name)
            return tuple(name for name in self._world.services if name in own)

    @property
    def actions(self) -> tuple[str, ...]:
        """Names of the actions of the model's devices and plugins, sorted."""
        with self._world.lock:
            own = self._world.session.simulation.actions(self.name)
            return tuple(name for name in self._world.actions if name in own)

    @overload
    def topic(self, name: str, type: type[M], *, keep: int | None = None) -> Topic[M]: ...
    @overload
    def topic(
        self, name: str, type: str | None = None, *, keep: int | None = None
    ) -> Topic[Any]: ...
    def topic(self, name: str, type: Kind | None = None, *, keep: int | None = None) -> Topic[Any]:
        """`World.topic`, where a name without a leading ``/`` is in the model's namespace."""
        full = self._resolved(name)
        # The overloads of `World.topic` know either a class or a name.
        return self._world.topic(full, cast("str | None", type), keep=keep)

    def publish(self, topic: str, message: Any = None, **fields: Any) -> None:
        """`World.publish`, where a name without a leading ``/`` is in the model's namespace."""
        self._world.publish(self._resolved(topic), message, **fields)

    @overload
    def subscribe(
        self, topic: str, callback: Callable[[M], object], *, type: type[M]
    ) -> Subscription: ...
    @overload
    def subscribe(
        self, topic: str, callback: Callable[[Any], object], *, type: str | None = None
    ) -> Subscription: ...
    def subscribe(
        self,
        topic: str,
        callback: Callable[[Any], object],
        *,
        type: Kind | None = None,
    ) -> Subscription:
        """`World.subscribe`, where a name without a leading ``/`` is in the model's namespace."""
        return self._world.subscribe(self._resolved(topic), callback, type=cast("str | None", type))

    @overload
    def mailbox(self, topic: str, type: type[M], *, size: int = 1000) -> Mailbox[M]: ...
    @overload
    def mailbox(self, topic: str, type: str | None = None, *, size: int = 1000) -> Mailbox[Any]: ...
    def mailbox(self, topic: str, type: Kind | None = None, *, size: int = 1000) -> Mailbox[Any]:
        """`World.mailbox`, where a name without a leading ``/`` is in the model's namespace."""
        return self._world.mailbox(self._resolved(topic), cast("str | None", type), size=size)

    def call(
        self, service: str, request: Any = None, *, timeout: float = TIMEOUT, **fields: Any
    ) -> Any:
        """`World.call`, where a name without a leading ``/`` is in the model's namespace."""
        full = self._resolved(service, "service")
        return self._world.call(full, request, timeout=timeout, **fields)

    @overload
    def serve(self, name: str, type: type[M], handler: Callable[[M], object]) -> ServiceServer: ...
    @overload
    def serve(self, name: str, type: str, handler: Callable[[Any], object]) -> ServiceServer: ...
    def serve(self, name: str, type: Kind, handler: Callable[[Any], object]) -> ServiceServer:
        """`World.serve`, where a name without a leading ``/`` is in the model's namespace."""
        return self._world.serve(self._resolved(name, "name"), cast("str", type), handler)

    @overload
    def serve_action(
        self,
        name: str,
        type: type[M],
        on_goal: Callable[[ReceivedGoal[M]], object],
        *,
        on_cancel: Callable[[ReceivedGoal[M]], object] | None = None,
    ) -> ActionServer: ...
    @overload
    def serve_action(
        self,
        name: str,
        type: str,
        on_goal: Callable[[ReceivedGoal[Any]], object],
        *,
        on_cancel: Callable[[ReceivedGoal[Any]], object] | None = None,
    ) -> ActionServer: ...
    def serve_action(
        self,
        name: str,
        type: Kind,
        on_goal: Callable[[ReceivedGoal[Any]], object],
        *,
        on_cancel: Callable[[ReceivedGoal[Any]], object] | None = None,
    ) -> ActionServer:
        """`World.serve_action`, where a name without a leading ``/`` is in the model's
        namespace.
        """
        full = self._resolved(name, "name")
        return self._world.serve_action(full, cast("str", type), on_goal, on_cancel=on_cancel)

    def send_goal(self, action: str, goal: Any = None, **fields: Any) -> Goal:
        """`World.send_goal`, where a name without a leading ``/`` is in the model's namespace."""
        return self._world.send_goal(self._resolved(action, "action"), goal, **fields)

    def fault(
        self,
        topics: str | Sequence[str],
        *,
        drop: float = 0.0,
        delay: float = 0.0,
        frozen: bool = False,
        noise: Mapping[str, float] | None = None,
        bias: Mapping[str, float] | None = None,
        change: Callable[[Any], Any] | None = None,
    ) -> Fault:
        """`World.fault`, where a name without a leading ``/`` is in the model's namespace."""
        names = [self._resolved(name, "topics") for name in several(topics, "topics")]
        return self._world.fault(
            names, drop=drop, delay=delay, frozen=frozen, noise=noise, bias=bias, change=change
        )

    def transform(self, target: str | Link, source: str | Link, time: Moment | None = None) -> Pose:
        """`World.transform`, where a name without a leading ``/`` has the model's frame prefix."""
        frames = (self._frame(target), self._frame(source))
        return self._world.transform(*frames, time)

    def _frame(self, frame: str | Link) -> str | Link:
        if not isinstance(frame, str):
            return frame
        with self._world.lock:
            return resolve_frame(frame, self._world.session.simulation.frame_prefix(self.name))

    def _resolved(self, name: str, argument: str = "topic") -> str:
        return resolve_name(text(name, argument), self.namespace)
