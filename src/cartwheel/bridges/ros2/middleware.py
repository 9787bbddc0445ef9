"""What the bridge needs of a middleware of ROS 2."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

from cartwheel.errors import GraphError
from cartwheel.graph import Qos
from cartwheel.messages import decode_cdr, encode_cdr
from cartwheel.messages.ros2_types import Ros2Service, Ros2Type

Reply = Callable[[bytes], None]
"""Sends a response: CDR with its encapsulation."""
Answer = Callable[[bytes, Reply], None]
"""Takes a request's CDR; replies at once or later, on the loop's thread."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Profile:
    """ROS 2's quality of service, as far as it differs among our topics."""

    reliable: bool = True
    transient_local: bool = False
    depth: int = 10
    lifespan: int = 0
    """s after which a message is none any more; 0 is never."""


LATCHED = Profile(transient_local=True, depth=1)
SENSOR = Profile(reliable=False, depth=5)
DEFAULT = Profile()
CALLS, PARAMETER_CALLS = 10, 1000
"""Depths of services, and of those for parameters. Source: rmw's qos_profiles.h."""
_BY_TOPIC = {
    "/tf": Profile(depth=100),
    "/tf_static": LATCHED,
    "/robot_description": LATCHED,
    "/rosout": Profile(transient_local=True, depth=1000, lifespan=10),
    "/parameter_events": Profile(depth=1000),
}


def profile_of(topic: str, qos: Qos) -> Profile:
    """How a topic of the graph is sent.

    Source: rmw's ``qos_profile_sensor_data``, tf2_ros, robot_state_publisher, rcl's rosout.
    """
    found = _BY_TOPIC.get(topic)
    if found is not None:
        return found
    return {"latched": LATCHED, "sensor": SENSOR, "default": DEFAULT}[qos]


@dataclass(frozen=True, slots=True)
class Served:
    """A version of a service's type with what answers those who have it."""

    type: Ros2Service
    answer: Answer

    def fits(self, data: bytes) -> bool:
        """Whether bytes can be a request."""
        try:
            again = encode_cdr(decode_cdr(data, self.type.request))
        except GraphError:
            return False
        return data[:4] != b"\0\1\0\0" or (data.startswith(again) and len(data) - len(again) < 4)

    def is_of(self, hash_: str) -> bool:
        """Whether that is the hash of the type, or of a part of it: others tell either."""
        return hash_ in (self.type.hash, self.type.request_hash, self.type.response_hash)


class Outlet(Protocol):
    """A topic that we publish."""

    @property
    def dropped(self) -> int:
        """Messages that readers have missed, as far as the middleware tells; on any thread."""

    def send(self, payload: bytes) -> None:
        """Sends a message's CDR to all readers."""

    def close(self) -> None:
        """Takes it off."""


class Closable(Protocol):
    """A subscription or service of ours."""

    def close(self) -> None:
        """Takes it off."""


class Middleware(Protocol):
    """DDS or Zenoh; on the loop's thread."""

    @property
    def description(self) -> str:
        """What and where it is, for the user."""

    def start(self) -> None:
        """Joins."""

    def close(self) -> None:
        """Leaves."""

    def publish(
        self,
        topic: str,
        type_: Ros2Type,
        profile: Profile,
        on_readers: Callable[[bool], None],
        *,
        node: str = "",
    ) -> Outlet:
        """Offers a topic.

        Args:
            topic: Its name.
            type_: Its type.
            profile: How it is sent.
            on_readers: Told when the first reader comes and the last goes.
            node: The node whose it is, with its namespace; the main one where it is empty.
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
        """Reads a topic; see `publish`."""

    def serve(self, name: str, served: Sequence[Served], *, depth: int, node: str = "") -> Closable:
        """Offers a service.

        Args:
            name: Of the service.
            served: Its type with what answers; then older versions that others may have.
            depth: Requests, and responses, that are kept.
            node: See `publish`.
        """

    def topics_of_others(self) -> set[str]:
        """The topics that other nodes publish; another simulation's do not count."""

    on_others: Callable[[], None]
    """Told when what other nodes offer has changed."""
