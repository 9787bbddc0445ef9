"""Structure of a ROS 2 type, as the ROS 2 message ``TypeDescription``."""

from __future__ import annotations

from typing import Any

from cartwheel.messages.learnt import learnt
from cartwheel.messages.ros2.hashes import field_type
from cartwheel.messages.ros2.types import fields_of
from cartwheel.messages.store import message_class

_PACKAGE = "type_description_interfaces/msg"


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
        type_ = message_class(f"{_PACKAGE}/FieldType")(**field_type(kind))
        fields.append(
            message_class(f"{_PACKAGE}/Field")(
                name=field, type=type_, default_value=defaults.get(field, "")
            )
        )
        if type_.nested_type_name:
            _describe(type_.nested_type_name, described)
