"""What ROS 2's middlewares call the types, and the hashes by which they tell them apart."""

from __future__ import annotations

import functools
import re
from dataclasses import dataclass
from typing import Any

from cartwheel.codes.graph import MESSAGE_TYPE_UNKNOWN
from cartwheel.errors import UnknownNameError
from cartwheel.messages.store import FIRST, TWIN, service_classes, service_name, store, type_name

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
_ROS1_TYPES = frozenset(
    {
        "rosgraph_msgs/msg/Log",
        "gazebo_msgs/msg/ODEJointProperties",
        "gazebo_msgs/srv/SetJointProperties",
        "gazebo_msgs/srv/SetLightProperties",
    }
)
_PART = re.compile(r"_(Request|Response|Event)\Z")


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
    known = store().fielddefs
    if full not in known or is_ros1_only(full):
        raise UnknownNameError("ROS 2 message type", full, known, code=MESSAGE_TYPE_UNKNOWN)
    real = ros2_name(full)
    return Ros2Type(name=real, dds=dds_name(real), hash=_hash_store().hash_rihs01(real))


@functools.cache
def ros2_service(name: str) -> Ros2Service:
    """Names and hashes of a service type ``pkg/srv/Name`` or ``pkg/Name``.

    The services of an action are such as well: ``pkg/action/Name_SendGoal``.

    Raises:
        UnknownNameError: ROS 2 has no such type.
    """
    full = service_name(name)
    if is_ros1_only(full):
        raise UnknownNameError("ROS 2 service type", name, (), code=MESSAGE_TYPE_UNKNOWN)
    request, response = (each.__msgtype__ for each in service_classes(full))
    real = ros2_name(full)
    made = _hash_store(first=_is_first(full))
    if real not in made.fielddefs:
        made.fielddefs |= _whole(real)
    return Ros2Service(
        name=real,
        dds=dds_name(real),
        hash=made.hash_rihs01(real),
        request=request,
        response=response,
        request_hash=made.hash_rihs01(f"{real}_Request"),
        response_hash=made.hash_rihs01(f"{real}_Response"),
    )


def ros2_hash_of(name: str) -> str:
    """The hash of a message or service type by ROS 2's name.

    Raises:
        UnknownNameError: ROS 2 has no such type.
    """
    fields_of(name)
    return str(_hash_store().hash_rihs01(name))


def fields_of(name: str) -> list[tuple[str, Any]]:
    """The fields of a message or service type by ROS 2's name, as ROS 2 hashes them.

    Raises:
        UnknownNameError: ROS 2 has no such type.
    """
    known = _hash_store().fielddefs
    if name not in known and "/msg/" not in name:
        service = _PART.sub("", name)
        twin = twin_name(service)
        ros2_service(twin if f"{twin}_Request" in store().fielddefs else service)
    if name not in known:
        raise UnknownNameError("ROS 2 type", name, known, code=MESSAGE_TYPE_UNKNOWN)
    from rosbags.interfaces import Nodetype

    # What rosidl puts into a type without fields.
    nothing = ("structure_needs_at_least_one_member", (Nodetype.BASE, ("uint8", 0)))
    return list(known[name][1]) or [nothing]


def ros2_name(name: str) -> str:
    """ROS 2's name of a type of the graph: that of a package with a twin is its own again."""
    package, slash, rest = name.partition("/")
    return f"{package.removesuffix(TWIN).removesuffix(FIRST)}{slash}{rest}"


def twin_name(name: str) -> str:
    """The graph's name of a type of ROS 2 whose package is another in ROS 1, if it is such."""
    package, slash, rest = name.partition("/")
    return f"{package}{TWIN}{slash}{rest}"


def is_ros1_only(name: str) -> bool:
    """Whether a type is none that a ROS 2 program could know."""
    return name.partition("/")[0] in _ROS1_ONLY or _PART.sub("", name) in _ROS1_TYPES


def dds_name(name: str) -> str:
    """``pkg/msg/Name`` as ``pkg::msg::dds_::Name_``."""
    package, kind, last = name.split("/")
    return f"{package}::{kind}::dds_::{last}_"


def _is_first(name: str) -> bool:
    """Whether a type of the graph is the first version of one that has two."""
    return name.partition("/")[0].endswith(FIRST)


def _hash_store(*, first: bool = False) -> Any:
    return _hash_stores()[first]


@functools.cache
def _hash_stores() -> tuple[Any, Any]:
    """Without first versions of types, and with them."""
    return _made_hash_store(first=False), _made_hash_store(first=True)


def _made_hash_store(*, first: bool) -> Any:
    """ROS 2's types alone, by ROS 2's names, as it hashes them: with ``uint8`` for ``char``.

    Args:
        first: Whether types that have two versions are there in the first one.
    """
    from rosbags.typesys import Stores, get_typestore

    made = get_typestore(Stores.ROS2_JAZZY)
    made.fielddefs = {
        ros2_name(name): (constants, [(field, _hashed(kind)) for field, kind in fields])
        # The first versions come last, in the others' place.
        for name, (constants, fields) in sorted(
            store().fielddefs.items(), key=lambda item: _is_first(item[0])
        )
        if not is_ros1_only(name) and (first or not _is_first(name))
    }
    return made


def _hashed(kind: Any) -> Any:
    from rosbags.interfaces import Nodetype

    node, value = kind
    if node == Nodetype.BASE:
        return (node, ("uint8", 0)) if value[0] == "char" else kind
    if node == Nodetype.NAME:
        return (node, ros2_name(value))
    return node, (_hashed(value[0]), value[1])


def _whole(full: str) -> dict[str, Any]:
    """A service as one type, which is what is hashed of it. Source: rosidl, REP 2016."""
    from rosbags.interfaces import Nodetype

    def one(name: str) -> Any:
        return (Nodetype.NAME, name)

    def at_most_one(name: str) -> Any:
        return (Nodetype.SEQUENCE, (one(name), 1))

    event, request, response = (f"{full}_{part}" for part in ("Event", "Request", "Response"))
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
