"""What a bridge needs of a graph, wherever that is."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future
from typing import Any, Protocol

from cartwheel.graph import ActionListener, Goal, ParameterServer, Service, TopicInfo


class BridgedSubscription(Protocol):
    """See `Subscription`."""

    dropped: Callable[[], int]

    def close(self) -> None:
        """Takes it off the graph."""


class BridgedParameters(Protocol):
    """See `Parameters`."""

    server: ParameterServer | None

    def get(self, name: str, default: Any = None) -> Any:
        """A value, or the mapping of a namespace."""

    def set(self, name: str, value: Any) -> None:
        """Stores a value."""


class BridgedAction(Protocol):
    """See `Action`; for the thread on which `BridgedGraph.post` runs functions."""

    @property
    def name(self) -> str:
        """Its name in the graph."""

    @property
    def type(self) -> str:
        """``pkg/action/Name``."""

    @property
    def node(self) -> str:
        """Who offers it."""

    @property
    def time_ns(self) -> Callable[[], int]:
        """Tells simulation time."""

    @property
    def goals(self) -> list[Goal]:
        """Those that are worked at and those that ended lately, in order."""

    def goal(self, identity: str) -> Goal | None:
        """One of `goals`."""

    def listen(self, listener: ActionListener) -> None:
        """Tells it of all goals from now on."""

    def leave(self, listener: ActionListener) -> None:
        """Tells it of goals no longer."""

    def submit(self, goal: Any, *, identity: str = "") -> Goal | None:
        """Hands a goal in; None where one of that name is known."""

    def cancel(self, *, identity: str = "", before_ns: int = 0) -> list[Goal]:
        """Calls goals off; returns those that were under way."""


class Packer(Protocol):
    """See `CdrCache`."""

    def encode(self, message: Any) -> bytes:
        """The message's CDR bytes."""


class BridgedGraph(Protocol):
    """A `Graph` in this process, or one in another."""

    @property
    def nodes(self) -> Mapping[str, str]:
        """See `Graph.nodes`."""

    @property
    def parameters(self) -> BridgedParameters:
        """All of them."""

    @property
    def cdr(self) -> Packer:
        """Packs messages that the graph has delivered."""

    @property
    def on_change(self) -> list[Callable[[], None]]:
        """Called after each change, on any thread: must return at once."""

    def post(self, function: Callable[[], None]) -> None:
        """Runs a function after all that was handed to the simulation before was taken."""

    def subscribe(
        self,
        name: str,
        callback: Callable[[Any], None],
        *,
        type_name: str | None = None,
        node: str = "cartwheel",
    ) -> BridgedSubscription:
        """A callback for each message, in order of publication."""

    def publish(self, name: str, type_name: str, message: Any) -> None:
        """Delivers one message."""

    def call(self, name: str, request: Any) -> Future[Any]:
        """Calls a service."""

    def topics(self) -> list[TopicInfo]:
        """All topics, by name."""

    def services(self) -> list[Service]:
        """All services, by name."""

    def actions(self) -> Sequence[BridgedAction]:
        """All actions, by name."""
