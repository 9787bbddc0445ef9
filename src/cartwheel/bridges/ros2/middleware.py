"""Interface of ROS 2 middlewares for the bridge."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

from cartwheel.errors import GraphError
from cartwheel.graph import Qos
from cartwheel.messages import decode_cdr, encode_cdr
from cartwheel.messages.ros2.types import Ros2Service, Ros2Type

Reply = Callable[[bytes], None]
"""Sends a response: CDR with encapsulation."""
Answer = Callable[[bytes, Reply], None]
"""Handles a request (CDR). Replies at once or later, on the loop's thread."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Profile:
    """ROS 2 QoS settings that differ between topics."""

    reliable: bool = True
    transient_local: bool = False
    depth: int = 10
    lifespan: int = 0
    """Time in s after which a message expires; 0 means never."""


LATCHED = Profile(transient_local=True, depth=1)
SENSOR = Profile(reliable=False, depth=5)
DEFAULT = Profile()
CALLS, PARAMETER_CALLS = 10, 1000
"""Queue depths of services, and of parameter services. Source: rmw's qos_profiles.h."""
_BY_TOPIC = {
    "/tf": Profile(depth=100),
    "/tf_static": LATCHED,
    "/robot_description": LATCHED,
    "/rosout": Profile(transient_local=True, depth=1000, lifespan=10),
    "/parameter_events": Profile(depth=1000),
}


def profile_of(topic: str, qos: Qos) -> Profile:
    """QoS of a topic in the graph.

    Source: rmw's ``qos_profile_sensor_data``, tf2_ros, robot_state_publisher, rcl's rosout.
    """
    found = _BY_TOPIC.get(topic)
    if found is not None:
        return found
    return {"latched": LATCHED, "sensor": SENSOR, "default": DEFAULT}[qos]


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


class Outlet(Protocol):
    """A published topic."""

    @property
    def dropped(self) -> int:
        """Messages that subscribers missed, if the middleware counts them. Thread-safe."""

    def send(self, payload: bytes) -> None:
        """Sends a CDR message to all subscribers."""

    def close(self) -> None:
        """Removes the topic."""


class Closable(Protocol):
    """A subscription or service."""

    def close(self) -> None:
        """Removes the subscription or service."""


class Middleware(Protocol):
    """DDS or Zenoh. Used on the loop's thread."""

    @property
    def description(self) -> str:
        """Description of the middleware and its domain, for the user."""

    def start(self) -> None:
        """Connects to other nodes."""

    def close(self) -> None:
        """Disconnects."""

    def publish(
        self,
        topic: str,
        type_: Ros2Type,
        profile: Profile,
        on_readers: Callable[[bool], None],
        *,
        node: str = "",
    ) -> Outlet:
        """Advertises a topic.

        Args:
            topic: Topic name.
            type_: Message type.
            profile: QoS of the topic.
            on_readers: Called when the first subscriber appears and when the last one disappears.
            node: Full name of the publishing node; empty for the main node.
        """

    def subscribe(
        self,
        topic: str,
        type_: Ros2Type,
        profile: Profile,
        take: Callable[[bytes], None],
        *,
        node: str = "",
    ) -> Closable:
        """Subscribes to a topic; see `publish`."""

    def serve(self, name: str, served: Sequence[Served], *, depth: int, node: str = "") -> Closable:
        """Offers a service.

        Args:
            name: Service name.
            served: Type and handler, followed by older versions that clients may use.
            depth: Queue depth for requests, and for responses.
            node: See `publish`.
        """

    def topics_of_others(self) -> set[str]:
        """Topics that other nodes publish, without those of other simulations."""

    on_others: Callable[[], None]
    """Called when the endpoints of other nodes change."""
