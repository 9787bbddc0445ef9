"""What a type of ROS 2 is made of, told in ROS 2's own messages."""

from __future__ import annotations

from typing import Any

from cartwheel.messages.ros2_types import fields_of
from cartwheel.messages.store import message_class

_PACKAGE = "type_description_interfaces/msg"
_ARRAY, _BOUNDED, _UNBOUNDED = 48, 96, 144
"""What a field's kind adds to its type's number. Source: FieldType.msg."""
_NAMES = {"bool": "BOOLEAN", "float32": "FLOAT", "float64": "DOUBLE", "octet": "BYTE"}
"""Those that FieldType.msg calls something else."""


def type_description(name: str) -> Any:
    """``TypeDescription`` of a message or service by ROS 2's name, with all types within it.

    Raises:
        UnknownNameError: ROS 2 has no such type.
    """
    described: dict[str, Any] = {}
    _describe(name, described)
    return message_class(f"{_PACKAGE}/TypeDescription")(
        type_description=described.pop(name),
        referenced_type_descriptions=[described[each] for each in sorted(described)],
    )


def _describe(name: str, described: dict[str, Any]) -> None:
    if name in described:
        return
    fields: list[Any] = []
    described[name] = message_class(f"{_PACKAGE}/IndividualTypeDescription")(
        type_name=name, fields=fields
    )
    for field, kind in fields_of(name):
        type_ = _field_type(kind)
        fields.append(message_class(f"{_PACKAGE}/Field")(name=field, type=type_, default_value=""))
        if type_.nested_type_name:
            _describe(type_.nested_type_name, described)


def _field_type(kind: Any) -> Any:
    from rosbags.interfaces import Nodetype

    node, value = kind
    more, capacity = 0, 0
    if node in (Nodetype.ARRAY, Nodetype.SEQUENCE):
        (node, value), capacity = value
        more = _ARRAY if kind[0] == Nodetype.ARRAY else _BOUNDED if capacity else _UNBOUNDED
    numbers = message_class(f"{_PACKAGE}/FieldType")
    nested, longest = "", 0
    if node == Nodetype.NAME:
        nested, own = value, "NESTED_TYPE"
    else:
        base, longest = value
        own = _NAMES.get(base, base.upper())
        own = f"BOUNDED_{own}" if longest else own
    return numbers(
        type_id=getattr(numbers, f"FIELD_TYPE_{own}") + more,
        capacity=capacity,
        string_capacity=longest,
        nested_type_name=nested,
    )
