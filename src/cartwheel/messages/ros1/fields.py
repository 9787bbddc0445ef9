"""Mapping of ROS 1 fields to the graph's fields.

The graph uses ROS 2 classes. Most types are identical. In the others, ``K`` becomes ``k``,
fields that ROS 1 lacks are omitted, and fields that ROS 2 lacks are zero.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Literal

from cartwheel.codes.graph import MESSAGE_TYPE_UNKNOWN
from cartwheel.errors import UnknownNameError
from cartwheel.messages.classes import FILLER
from cartwheel.messages.field import Field, field_of
from cartwheel.messages.fields import fields
from cartwheel.messages.ros1.types import ros1_store
from cartwheel.messages.store import type_name

HEADER = "std_msgs/msg/Header"


@dataclass(frozen=True, kw_only=True, slots=True)
class Pair:
    """A ROS 1 field and the corresponding field of the graph's message."""

    field: Field
    """The ROS 1 field. Its type determines how numbers are read and written."""
    name: str | None
    """The graph's field name; None if the graph's message has no such field."""

    @property
    def form(self) -> Literal["number", "string", "numbers", "list"]:
        """Encoding: fixed size, string with length, array of numbers, or element by element."""
        if self.field.array:
            return "list" if self.field.kind in ("string", "message") else "numbers"
        return "string" if self.field.kind == "string" else "number"


@functools.cache
def pairs(name: str) -> tuple[Pair, ...]:
    """Fields of a ROS 1 message type in order.

    Raises:
        UnknownNameError: ROS 1 does not have this type.
    """
    full = type_name(name)
    known = ros1_store().fielddefs
    if full not in known:
        raise UnknownNameError("ROS 1 message type", full, known, code=MESSAGE_TYPE_UNKNOWN)
    ours = {field.name: field for field in fields(full)}
    found = []
    for ros1, description in known[full][1]:
        if ros1 == FILLER:
            continue
        field = field_of(ros1, description)
        like = ours.get(ros1) or ours.get(ros1.lower())
        same = like is not None and _alike(field, like)
        found.append(Pair(field=field, name=like.name if like and same else None))
    return tuple(found)


def _alike(one: Field, other: Field) -> bool:
    if (one.array, one.length, one.kind) != (other.array, other.length, other.kind):
        return False
    return one.kind != "message" or one.type == other.type
