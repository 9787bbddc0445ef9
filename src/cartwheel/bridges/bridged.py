"""The part of a graph that a bridge uses, in the same or in a different process."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future
from typing import Any, Protocol

from cartwheel.graph import (
    ActionListener,
    Goal,
    ParameterServer,
    Service,
    TakeValues,
    TopicInfo,
)


class BridgedSubscription(Protocol):
    """See `Subscription`."""

    dropped: Callable[[], int]

    def close(self) -> None:
        """Unsubscribes."""


class BridgedParameters(Protocol):
    """See `Parameters`."""

    server: ParameterServer | None

    def get(self, name: str, default: Any = None) -> Any:
        """A value, or the mapping of a namespace."""

    def set(self, name: str, value: Any) -> None:
        """Sets a value."""


class Named(Protocol):
    """A service or action."""

    @property
    def name(self) -> str:
        """Name in the graph."""

    @property
    def type(self) -> str:
        """``pkg/srv/Name`` or ``pkg/action/Name``."""

    @property
    def node(self) -> str:
        """Node that offers it."""


class BridgedAction(Named, Protocol):
    """See `Action`. Call it on the thread on which `BridgedGraph.post` runs functions."""

    @property
    def time_ns(self) -> Callable[[], int]:
        """Returns the simulation time."""

    @property
    def goals(self) -> list[Goal]:
        """Active and recently completed goals, in the order of submission."""

    def goal(self, identity: str) -> Goal | None:
        """The known goal with this identifier, or None."""

    def listen(self, listener: ActionListener) -> None:
        """Adds a listener, which is notified of all goals from now on."""

    def leave(self, listener: ActionListener) -> None:
        """Removes a listener."""

    def submit(self, goal: Any, *, identity: str = "") -> Goal | None:
        """Submits a goal. Returns None if a goal with this identifier already exists."""

    def cancel(self, *, identity: str = "", before_ns: int = 0) -> list[Goal]:
        """Cancels goals. Returns the goals that were active."""


class Packer(Protocol):
    """See `CdrCache`."""

    def encode(self, message: Any) -> bytes:
        """CDR bytes of a message."""


class BridgedGraph(Protocol):
    """A `Graph` in this process, or a graph in a different process."""

    @property
    def nodes(self) -> Mapping[str, str]:
        """See `Graph.nodes`."""

    @property
    def parameters(self) -> BridgedParameters:
        """All parameters."""

    @property
    def cdr(self) -> Packer:
        """Serialises messages that the graph has delivered."""

    @property
    def on_change(self) -> list[Callable[[], None]]:
        """Called after each change, on any thread. The functions must return at once."""

    def post(self, function: Callable[[], None]) -> None:
        """Runs a function after the simulation has processed all previous messages and calls."""

    def subscribe(
        self,
        name: str,
        callback: Callable[[Any], None],
        *,
        type_name: str | None = None,
        node: str = "cartwheel",
        take_values: TakeValues | None = None,
    ) -> BridgedSubscription:
        """Calls `callback` with each message, in the order of publication.

        Only a graph in this process calls `take_values`; see `Graph.subscribe`.
        """

    def publish(self, name: str, type_name: str, message: Any) -> None:
        """Publishes one message."""

    def call(self, name: str, request: Any) -> Future[Any]:
        """Calls a service."""

    def topics(self) -> list[TopicInfo]:
        """All topics, sorted by name."""

    def services(self) -> list[Service]:
        """All services, sorted by name."""

    def actions(self) -> Sequence[BridgedAction]:
        """All actions, sorted by name."""
