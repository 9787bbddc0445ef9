"""ROS 1 names of message types, with md5 sums and definitions."""

from __future__ import annotations

import functools
import hashlib
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from cartwheel.codes.graph import MESSAGE_TYPE_UNKNOWN
from cartwheel.errors import UnknownNameError
from cartwheel.messages.classes import FILLER
from cartwheel.messages.definition import Definition
from cartwheel.messages.learnt import learnt, learnt_since, text_with_nested
from cartwheel.messages.store import learning, parsed_definitions, service_name, type_name

_PRIMITIVES = {
    "builtin_interfaces/msg/Time": "time",
    "builtin_interfaces/msg/Duration": "duration",
}


@dataclass(frozen=True, kw_only=True, slots=True)
class Ros1Type:
    """A message type as sent in a ROS 1 connection header."""

    name: str
    """``pkg/Name``."""
    md5: str
    definition: str
    """Definition, including all nested types."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Ros1Service:
    """A service type as sent in a ROS 1 connection header."""

    name: str
    """``pkg/Name``."""
    md5: str
    request: str
    """Type of the request in the graph."""


def ros1_store() -> Any:
    """Typestore for ROS 1: Noetic's types, Cartwheel's definitions, and those found in packages.

    Types that are not from Noetic have no classes here, because encoding and decoding do not need
    any.
    """
    made, added = _ros1_store()
    with learning:
        for each in learnt_since(len(added)):
            added.append(each.name)
            if not each.has_wide_text and all(used.type in made.fielddefs for used in each.uses):
                made.fielddefs.setdefault(each.name, each.fielddefs(bounded=False))
    return made


@functools.cache
def _ros1_store() -> tuple[Any, list[str]]:
    """The store, and the names of the types that were added to it."""
    from rosbags.typesys import Stores, get_typestore

    made = get_typestore(Stores.ROS1_NOETIC)
    # rosbags shares this table between all stores of the same kind.
    made.fielddefs = {**parsed_definitions(), **made.fielddefs}
    return made, []


def ros1_name(name: str) -> str:
    """ROS 1 name of a message or service type: ``pkg/msg/Name`` becomes ``pkg/Name``."""
    package, _, rest = name.partition("/")
    return f"{package}/{rest.rpartition('/')[2]}"


@functools.cache
def ros1_type(name: str) -> Ros1Type:
    """Name, md5 sum and definition of a message type.

    Raises:
        UnknownNameError: ROS 1 does not have this type.
    """
    full = _known(type_name(name))
    if learnt(full) is None:
        text, md5 = ros1_store().generate_msgdef(full)
    else:
        text, md5 = text_with_nested(full, 1, ros1_store(), ros1_name), _md5(_hashed_text(full))
    return Ros1Type(name=ros1_name(full), md5=md5, definition=text)


@functools.cache
def ros1_service(name: str) -> Ros1Service:
    """Name and md5 sum of a service type ``pkg/srv/Name`` or ``pkg/Name``.

    Raises:
        UnknownNameError: The type does not exist.
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
    return Ros1Service(name=ros1_name(full), md5=_md5(text), request=request)


def _known(full: str) -> str:
    if full not in ros1_store().fielddefs:
        raise UnknownNameError(
            "ROS 1 message type", full, ros1_store().fielddefs, code=MESSAGE_TYPE_UNKNOWN
        )
    return full


def _md5(text: str) -> str:
    return hashlib.md5(text.encode(), usedforsecurity=False).hexdigest()


def _hashed_text(full: str) -> str:
    """Definition without comments, in which the md5 sums of nested types replace their names.

    Source: genmsg, ``compute_md5_text``.
    """
    return "\n".join(_hashed_lines(full))


def _hashed_lines(full: str) -> Iterator[str]:
    from rosbags.interfaces import Nodetype

    known = learnt(full)
    if known is not None:
        yield from _learnt_lines(known)
        return
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
            # The hash of an array of messages contains the md5 sum of one message.
            yield f"{_md5(_hashed_text(inner))} {name}"


def _learnt_lines(known: Definition) -> Iterator[str]:
    for constant in known.constants:
        text = constant.text
        if known.dialect == "ros2" and constant.type == "string":
            text = str(constant.value)
        yield f"{constant.type} {constant.name}={text}"
    for field in known.fields:
        if field.is_message and field.type not in _PRIMITIVES:
            yield f"{_md5(_hashed_text(field.type))} {field.name}"
        else:
            yield field.written(1)
