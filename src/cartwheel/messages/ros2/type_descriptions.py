"""Structure of a ROS 2 type, as the ROS 2 message ``TypeDescription``."""

from __future__ import annotations

from typing import Any

from cartwheel.messages.learnt import learnt
from cartwheel.messages.ros2.types import fields_of
from cartwheel.messages.store import message_class

_PACKAGE = "type_description_interfaces/msg"
_ARRAY, _BOUNDED, _UNBOUNDED = 48, 96, 144
"""Offsets of array kinds, which are added to the type's number. Source: FieldType.msg."""
_NAMES = {"bool": "BOOLEAN", "float32": "FLOAT", "float64": "DOUBLE", "octet": "BYTE"}
"""Types that have a different name in FieldType.msg."""


def type_description(name: str) -> Any:
    """``TypeDescription`` of a message or service with this ROS 2 name, with all nested types.

    Raises:
        UnknownNameError: ROS 2 does not have this type.
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
    known = learnt(name)
    stated = () if known is None else known.fields
    defaults = {field.name: field.default_text for field in stated}
    for field, kind in fields_of(name):
        type_ = _field_type(kind)
        fields.append(
            message_class(f"{_PACKAGE}/Field")(
                name=field, type=type_, default_value=defaults.get(field, "")
            )
        )
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
