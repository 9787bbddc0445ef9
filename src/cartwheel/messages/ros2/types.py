"""Names and hashes of types in ROS 2 middlewares."""

from __future__ import annotations

import functools
import re
from dataclasses import dataclass
from typing import Any

from cartwheel.codes.graph import MESSAGE_TYPE_UNKNOWN
from cartwheel.errors import UnknownNameError
from cartwheel.messages.learnt import learnt, learnt_since
from cartwheel.messages.ros2.hashes import rihs01
from cartwheel.messages.store import (
    FIRST,
    TWIN,
    exists,
    is_bundled,
    learning,
    loaded,
    message_class,
    service_classes,
    service_name,
    type_name,
    type_names,
)

_ROS1_ONLY = frozenset(
    {
        "controller_manager_msgs",
        "control_msgs",
        "dynamic_reconfigure",
        "hector_gazebo_plugins",
        "roscpp",
    }
)
"""Packages that do not exist in ROS 2, or whose definitions here exist only in ROS 1."""
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
    """A message type in ROS 2."""

    name: str
    """``pkg/msg/Name``."""
    dds: str
    """``pkg::msg::dds_::Name_``."""
    hash: str
    """``RIHS01_…``."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Ros2Service:
    """A service type in ROS 2."""

    name: str
    """``pkg/srv/Name``."""
    dds: str
    """``pkg::srv::dds_::Name_``."""
    hash: str
    request: str
    """Type of the request in the graph."""
    response: str
    request_hash: str
    response_hash: str

    @property
    def dds_request(self) -> str:
        """DDS type of requests."""
        return f"{self.dds}Request_"

    @property
    def dds_response(self) -> str:
        """DDS type of responses."""
        return f"{self.dds}Response_"


@functools.cache
def ros2_type(name: str) -> Ros2Type:
    """ROS 2 names and hash of a message type.

    Raises:
        UnknownNameError: ROS 2 does not have this type.
    """
    full = type_name(name)
    if not exists(full) or is_ros1_only(full):
        known = type_names()
        raise UnknownNameError("ROS 2 message type", full, known, code=MESSAGE_TYPE_UNKNOWN)
    real = ros2_name(full)
    return Ros2Type(name=real, dds=dds_name(real), hash=rihs01(_hashed_types(), real))


@functools.cache
def ros2_service(name: str) -> Ros2Service:
    """ROS 2 names and hashes of a service type ``pkg/srv/Name`` or ``pkg/Name``.

    The services of an action are service types as well: ``pkg/action/Name_SendGoal``.

    Raises:
        UnknownNameError: ROS 2 does not have this type.
    """
    full = service_name(name)
    if is_ros1_only(full):
        raise UnknownNameError("ROS 2 service type", name, (), code=MESSAGE_TYPE_UNKNOWN)
    request, response = (each.__msgtype__ for each in service_classes(full))
    real = ros2_name(full)
    made = _hashed_types(first=full.partition("/")[0].endswith(FIRST))
    if real not in made:
        made |= _whole(real)
    return Ros2Service(
        name=real,
        dds=dds_name(real),
        hash=rihs01(made, real),
        request=request,
        response=response,
        request_hash=rihs01(made, f"{real}_Request"),
        response_hash=rihs01(made, f"{real}_Response"),
    )


def ros2_hash_of(name: str) -> str:
    """Hash of a message or service type with this ROS 2 name.

    Raises:
        UnknownNameError: ROS 2 does not have this type.
    """
    fields_of(name)
    return rihs01(_hashed_types(), name)


def fields_of(name: str) -> list[tuple[str, Any]]:
    """Fields of a message or service type with this ROS 2 name, as ROS 2 hashes them.

    Raises:
        UnknownNameError: ROS 2 does not have this type.
    """
    known = _hashed_types()
    if name not in known and "/msg/" not in name:
        service = _PART.sub("", name)
        twin = twin_name(service)
        ros2_service(twin if exists(f"{twin}_Request") else service)
    if name not in known:
        names = [ros2_name(each) for each in type_names() if not is_ros1_only(each)]
        raise UnknownNameError("ROS 2 type", name, names, code=MESSAGE_TYPE_UNKNOWN)
    from rosbags.interfaces import Nodetype

    # rosidl adds this field to a type without fields.
    nothing = ("structure_needs_at_least_one_member", (Nodetype.BASE, ("uint8", 0)))
    return list(known[name][1]) or [nothing]


def ros2_name(name: str) -> str:
    """ROS 2 name of a type in the graph: the suffix of the package name is removed."""
    package, slash, rest = name.partition("/")
    return f"{package.removesuffix(TWIN).removesuffix(FIRST)}{slash}{rest}"


def twin_name(name: str) -> str:
    """The graph's name of a ROS 2 type whose package contains different types in ROS 1."""
    package, slash, rest = name.partition("/")
    return f"{package}{TWIN}{slash}{rest}"


def is_ros1_only(name: str) -> bool:
    """Whether a type does not exist in ROS 2."""
    if learnt(name) is not None:
        return False
    return name.partition("/")[0] in _ROS1_ONLY or _PART.sub("", name) in _ROS1_TYPES


def dds_name(name: str) -> str:
    """``pkg/msg/Name`` as ``pkg::msg::dds_::Name_``."""
    package, kind, last = name.split("/")
    return f"{package}::{kind}::dds_::{last}_"


def _hashed_types(*, first: bool = False) -> _HashedTypes:
    made, added = _all_hashed_types()
    with learning:
        for each in learnt_since(len(added)):
            added.append(each.name)
            constants, kinds = each.fielddefs(hashed=True)
            described = [(field, _hashed(kind)) for field, kind in kinds]
            for types in made:
                types.setdefault(each.name, (constants, described))
    return made[first]


@functools.cache
def _all_hashed_types() -> tuple[tuple[_HashedTypes, _HashedTypes], list[str]]:
    """Types without and with the first versions of types, and the types that were learnt."""
    return (_HashedTypes(first=False), _HashedTypes(first=True)), []


class _HashedTypes(dict[str, Any]):
    """ROS 2 types by their ROS 2 names, with ``uint8`` for ``char``, in the form of rosbags.

    ROS 2 computes its hashes from these types. Each is read when it is needed, because reading
    all takes longer than the start of a bridge.

    Args:
        first: Whether types with two versions are in their first version.
    """

    def __init__(self, *, first: bool) -> None:
        super().__init__()
        self._first = first

    def __contains__(self, name: object) -> bool:
        try:
            self[str(name)]
        except KeyError:
            return False
        return True

    def __missing__(self, name: str) -> Any:
        package, slash, rest = name.partition("/")
        suffixes = (FIRST, "", TWIN) if self._first else ("", TWIN)
        for suffix in suffixes:
            full = f"{package}{suffix}{slash}{rest}"
            if ros2_name(full) == name and is_bundled(full) and not is_ros1_only(full):
                message_class(full)
                constants, fields = loaded().fielddefs[full]
                self[name] = constants, [(field, _hashed(kind)) for field, kind in fields]
                return self[name]
        raise KeyError(name)


def _hashed(kind: Any) -> Any:
    from rosbags.interfaces import Nodetype

    node, value = kind
    if node == Nodetype.BASE:
        return (node, ("uint8", 0)) if value[0] == "char" else kind
    if node == Nodetype.NAME:
        return (node, ros2_name(value))
    return node, (_hashed(value[0]), value[1])


def _whole(full: str) -> dict[str, Any]:
    """A service as a single type, which ROS 2 hashes. Source: rosidl, REP 2016."""
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
