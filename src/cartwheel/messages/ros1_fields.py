"""Which field of a graph's message each field of ROS 1's is.

The graph holds ROS 2's classes. Most types agree; where they do not, ``K`` is ``k``, what
ROS 1 lacks is left out, and what ROS 2 lacks is zero.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Literal

from cartwheel.codes.graph import MESSAGE_TYPE_UNKNOWN
from cartwheel.errors import UnknownNameError
from cartwheel.messages.fields import FILLER, Field, field_of, fields
from cartwheel.messages.ros1_types import ros1_store
from cartwheel.messages.store import type_name

HEADER = "std_msgs/msg/Header"


@dataclass(frozen=True, kw_only=True, slots=True)
class Pair:
    """A field of ROS 1's message and its like in the graph's."""

    field: Field
    """ROS 1's; numbers are read and written as it says."""
    name: str | None
    """The graph's; None where the graph's message has nothing of the kind."""

    @property
    def form(self) -> Literal["number", "string", "numbers", "list"]:
        """How it is written: fixed size, counted text, array of numbers, or one by one."""
        if self.field.array:
            return "list" if self.field.kind in ("string", "message") else "numbers"
        return "string" if self.field.kind == "string" else "number"


@functools.cache
def pairs(name: str) -> tuple[Pair, ...]:
    """The fields of a ROS 1 message type, in order.

    Raises:
        UnknownNameError: ROS 1 has no such type.
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
