"""What ROS 2's middlewares call the types, and the hashes by which they tell them apart."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Any

from cartwheel.errors import UnknownNameError
from cartwheel.messages.store import service_classes, store, type_name

_ROS1_ONLY = frozenset(
    {
        "controller_manager_msgs",
        "control_msgs",
        "dynamic_reconfigure",
        "hector_gazebo_plugins",
        "roscpp",
    }
)
"""Packages that ROS 2 does not have, or whose texts here are ROS 1's alone."""
_ROS1_TYPES = frozenset({"rosgraph_msgs/msg/Log"})


@dataclass(frozen=True, kw_only=True, slots=True)
class Ros2Type:
    """A message type as ROS 2 states it."""

    name: str
    """``pkg/msg/Name``."""
    dds: str
    """``pkg::msg::dds_::Name_``."""
    hash: str
    """``RIHS01_…``."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Ros2Service:
    """A service type as ROS 2 states it."""

    name: str
    """``pkg/srv/Name``."""
    dds: str
    """``pkg::srv::dds_::Name_``."""
    hash: str
    request: str
    """The graph's name of the request's type."""
    response: str
    request_hash: str
    response_hash: str

    @property
    def dds_request(self) -> str:
        """The type of requests."""
        return f"{self.dds}Request_"

    @property
    def dds_response(self) -> str:
        """The type of responses."""
        return f"{self.dds}Response_"


@functools.cache
def ros2_type(name: str) -> Ros2Type:
    """Names and hash of a message type.

    Raises:
        UnknownNameError: ROS 2 has no such type.
    """
    full = type_name(name)
    known = _hash_store().fielddefs
    if full not in known or is_ros1_only(full):
        raise UnknownNameError("ROS 2 message type", full, known)
    return Ros2Type(name=full, dds=dds_name(full), hash=_hash_store().hash_rihs01(full))


@functools.cache
def ros2_service(name: str) -> Ros2Service:
    """Names and hashes of a service type ``pkg/srv/Name`` or ``pkg/Name``.

    Raises:
        UnknownNameError: ROS 2 has no such type.
    """
    package, _, rest = name.partition("/")
    full = f"{package}/srv/{rest.rpartition('/')[2]}"
    if is_ros1_only(full):
        raise UnknownNameError("ROS 2 service type", name, ())
    request, response = (each.__msgtype__ for each in service_classes(full))
    made = _hash_store()
    if full not in made.fielddefs:
        made.fielddefs |= _whole(full, request, response)
    return Ros2Service(
        name=full,
        dds=dds_name(full),
        hash=made.hash_rihs01(full),
        request=request,
        response=response,
        request_hash=made.hash_rihs01(request),
        response_hash=made.hash_rihs01(response),
    )


def is_ros1_only(name: str) -> bool:
    """Whether a type is none that a ROS 2 program could know."""
    return name.partition("/")[0] in _ROS1_ONLY or name in _ROS1_TYPES


def dds_name(name: str) -> str:
    """``pkg/msg/Name`` as ``pkg::msg::dds_::Name_``."""
    package, kind, last = name.split("/")
    return f"{package}::{kind}::dds_::{last}_"


@functools.cache
def _hash_store() -> Any:
    """A store to hash in: fields as ROS 2 hashes them, which is with ``uint8`` for ``char``."""
    from rosbags.typesys import Stores, get_typestore

    made = get_typestore(Stores.ROS2_JAZZY)
    made.fielddefs = {
        name: (constants, [(field, _hashed(kind)) for field, kind in fields])
        for name, (constants, fields) in store().fielddefs.items()
    }
    return made


def _hashed(kind: Any) -> Any:
    from rosbags.interfaces import Nodetype

    node, value = kind
    if node == Nodetype.BASE:
        return (node, ("uint8", 0)) if value[0] == "char" else kind
    if node == Nodetype.NAME:
        return kind
    return node, (_hashed(value[0]), value[1])


def _whole(full: str, request: str, response: str) -> dict[str, Any]:
    """A service as one type, which is what is hashed of it. Source: rosidl, REP 2016."""
    from rosbags.interfaces import Nodetype

    def one(name: str) -> Any:
        return (Nodetype.NAME, name)

    def at_most_one(name: str) -> Any:
        return (Nodetype.SEQUENCE, (one(name), 1))

    event = f"{full}_Event"
    return {
        event: (
            [],
            [
                ("info", one("service_msgs/msg/ServiceEventInfo")),
                ("request", at_most_one(request)),
                ("response", at_most_one(response)),
            ],
        ),
        full: (
            [],
            [
                ("request_message", one(request)),
                ("response_message", one(response)),
                ("event_message", one(event)),
            ],
        ),
    }
