"""The interface through which the bridge uses DDS or Zenoh."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

from cartwheel.bridges.loop import Coalesced, Loop
from cartwheel.bridges.mirror import Closable
from cartwheel.bridges.ros2.environment import discovery_range, domain_id
from cartwheel.bridges.ros2.qos import Profile, profile_of
from cartwheel.errors import Diagnostic, GraphError
from cartwheel.graph import Qos
from cartwheel.messages import decode_cdr, encode_cdr
from cartwheel.messages.ros2.types import Ros2Service, Ros2Type, ros2_type

_GATHER = 0.03
"""Delay in s during which changes of other nodes are collected."""

Reply = Callable[[bytes], None]
"""Sends a response: CDR with encapsulation."""
Answer = Callable[[bytes, Reply], None]
"""Handles a request (CDR). Replies at once or later, on the loop's thread."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Endpoint:
    """A publisher, a subscription or a service of a ROS 2 node."""

    name: str
    """Name of the topic or service."""
    type: Ros2Type | Ros2Service
    profile: Profile
    node: str = ""
    """Full name of the node; empty for the main node."""


def publisher(topic: str, type_name: str, qos: Qos = "default", node: str = "") -> Endpoint:
    """A publisher with the QoS that ROS 2 uses for the topic; see `profile_of`.

    Raises:
        UnknownNameError: ROS 2 does not have this message type.
    """
    return Endpoint(
        name=topic, type=ros2_type(type_name), profile=profile_of(topic, qos), node=node
    )


@dataclass(frozen=True, slots=True)
class Served:
    """A version of a service type, and the handler for its requests."""

    type: Ros2Service
    answer: Answer

    def fits(self, data: bytes) -> bool:
        """Whether the bytes can be decoded as a request."""
        try:
            again = encode_cdr(decode_cdr(data, self.type.request))
        except GraphError:
            return False
        return data[:4] != b"\0\1\0\0" or (data.startswith(again) and len(data) - len(again) < 4)

    def is_of(self, hash_: str) -> bool:
        """Whether this is the hash of the type, request or response, which others may use."""
        return hash_ in (self.type.hash, self.type.request_hash, self.type.response_hash)


class Outlet(Closable, Protocol):
    """A published topic."""

    @property
    def dropped(self) -> int:
        """Messages that subscribers missed, if the middleware counts them. Thread-safe."""

    def send(self, payload: bytes) -> None:
        """Sends a CDR message to all subscribers."""


def ignore(_: bool) -> None:
    """Does nothing when the first subscriber appears or the last one disappears."""


class Middleware(ABC):
    """DDS or Zenoh. Used on the loop's thread.

    Args:
        loop: Event loop of the bridge.
        node: Full name of the main node.
        warn: Receives warnings.

    Raises:
        CartwheelError: A ROS environment variable is invalid, or the middleware is not available.
    """

    def __init__(self, loop: Loop, node: str, warn: Callable[[Diagnostic], None]) -> None:
        self.loop = loop
        self.node = node
        self.warn = warn
        self.domain = domain_id()
        self.reach = discovery_range()
        self.on_others: Callable[[], None] = lambda: None
        """Called when the endpoints of other nodes have changed."""
        self._others_changed = Coalesced(loop, _GATHER, self._notify_of_others)

    def _notify_of_others(self) -> None:
        self.on_others()

    @property
    @abstractmethod
    def description(self) -> str:
        """Description of the middleware and its domain, for the user."""

    @abstractmethod
    def start(self) -> None:
        """Connects to other nodes."""

    @abstractmethod
    def close(self) -> None:
        """Disconnects."""

    @abstractmethod
    def publish(self, endpoint: Endpoint, on_readers: Callable[[bool], None] = ignore) -> Outlet:
        """Advertises a topic.

        Args:
            endpoint: Topic, message type and node.
            on_readers: Called when the first subscriber appears and when the last one disappears.
        """

    @abstractmethod
    def subscribe(self, endpoint: Endpoint, take: Callable[[bytes], None]) -> Closable:
        """Subscribes to a topic, and calls `take` with each CDR message."""

    @abstractmethod
    def serve(self, endpoint: Endpoint, versions: Sequence[Served]) -> Closable:
        """Offers a service.

        Args:
            endpoint: Service, newest type and node. The depth of its profile is that of the queue
                for requests, and of the queue for responses.
            versions: Newest type with its handler, followed by older versions that clients may use.
        """

    @abstractmethod
    def topics_of_others(self) -> set[str]:
        """Topics that other nodes publish, without those of other simulations."""
