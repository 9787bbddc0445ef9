"""What ROS 1 calls the message types, and how it tells them apart."""

from __future__ import annotations

import functools
import hashlib
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from cartwheel.codes.graph import MESSAGE_TYPE_UNKNOWN
from cartwheel.errors import UnknownNameError
from cartwheel.messages.fields import FILLER
from cartwheel.messages.store import parsed_definitions, service_name, type_name

_PRIMITIVES = {
    "builtin_interfaces/msg/Time": "time",
    "builtin_interfaces/msg/Duration": "duration",
}


@dataclass(frozen=True, kw_only=True, slots=True)
class Ros1Type:
    """A message type as a ROS 1 connection states it."""

    name: str
    """``pkg/Name``."""
    md5: str
    definition: str
    """With the definitions of all types within it."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Ros1Service:
    """A service type as a ROS 1 connection states it."""

    name: str
    """``pkg/Name``."""
    md5: str
    request: str
    """The graph's name of the request's type."""
    response: str


@functools.cache
def ros1_store() -> Any:
    """The typestore of ROS 1: Noetic's types and the fields of our definitions.

    It has no classes for ours, since messages are written and read without.
    """
    from rosbags.typesys import Stores, get_typestore

    made = get_typestore(Stores.ROS1_NOETIC)
    # It shares the table with all stores of its kind.
    made.fielddefs = {**parsed_definitions(), **made.fielddefs}
    return made


def ros1_name(name: str) -> str:
    """ROS 1's name of a message or service type: ``pkg/msg/Name`` is ``pkg/Name``."""
    package, _, rest = name.partition("/")
    return f"{package}/{rest.rpartition('/')[2]}"


@functools.cache
def ros1_type(name: str) -> Ros1Type:
    """Name, md5 sum and definition of a message type.

    Raises:
        UnknownNameError: ROS 1 has no such type.
    """
    full = _known(type_name(name))
    text, md5 = ros1_store().generate_msgdef(full)
    return Ros1Type(name=ros1_name(full), md5=md5, definition=text)


@functools.cache
def ros1_service(name: str) -> Ros1Service:
    """Name and md5 sum of a service type ``pkg/srv/Name`` or ``pkg/Name``.

    Raises:
        UnknownNameError: There is no such type.
    """
    full = service_name(name)
    request, response = f"{full}_Request", f"{full}_Response"
    if request not in ros1_store().fielddefs:
        services = [key for key in ros1_store().fielddefs if key.endswith("_Request")]
        raise UnknownNameError(
            "ROS 1 service type",
            name,
            [key.removesuffix("_Request") for key in services],
            code=MESSAGE_TYPE_UNKNOWN,
        )
    text = _hashed_text(request) + _hashed_text(response)
    return Ros1Service(name=ros1_name(full), md5=_md5(text), request=request, response=response)


def _known(full: str) -> str:
    if full not in ros1_store().fielddefs:
        raise UnknownNameError(
            "ROS 1 message type", full, ros1_store().fielddefs, code=MESSAGE_TYPE_UNKNOWN
        )
    return full


def _md5(text: str) -> str:
    return hashlib.md5(text.encode(), usedforsecurity=False).hexdigest()


def _hashed_text(full: str) -> str:
    """A definition without comments, its inner types replaced by their own md5 sums.

    Source: genmsg, ``compute_md5_text``.
    """
    return "\n".join(_hashed_lines(full))


def _hashed_lines(full: str) -> Iterator[str]:
    from rosbags.interfaces import Nodetype

    constants, fields = ros1_store().fielddefs[full]
    for name, base, value in constants:
        yield f"{base} {name}={value}"
    for name, (node, inner) in fields:
        if name == FILLER:
            continue
        if node in (Nodetype.ARRAY, Nodetype.SEQUENCE):
            (node, inner), length = inner  # noqa: PLW2901
            length = length or ""
            array = f"[{length}]"
        else:
            array = ""
        if node == Nodetype.BASE:
            yield f"{inner[0]}{array} {name}"
        elif inner in _PRIMITIVES:
            yield f"{_PRIMITIVES[inner]}{array} {name}"
        else:
            # An array of messages hashes as one of them does.
            yield f"{_md5(_hashed_text(inner))} {name}"
