"""``get_type_description``, a service of all nodes in Jazzy and later."""

from __future__ import annotations

from typing import Any

from cartwheel.codes.graph import MESSAGE_TYPE_UNKNOWN
from cartwheel.errors import UnknownNameError
from cartwheel.messages import zero
from cartwheel.messages.ros2.type_descriptions import type_description
from cartwheel.messages.ros2.types import ros2_hash_of

TYPE = "type_description_interfaces/srv/GetTypeDescription"


def get_type_description(request: Any) -> Any:
    """Returns the structure of a type, without source text, as for types created at run time."""
    response = zero(f"{TYPE}_Response")
    try:
        known = ros2_hash_of(request.type_name)
        if request.type_hash != known:
            raise UnknownNameError(
                "hash of this type", request.type_hash, [known], code=MESSAGE_TYPE_UNKNOWN
            )
        response.type_description = type_description(request.type_name)
    except UnknownNameError as error:
        response.failure_reason = error.message
        return response
    response.successful = True
    if request.include_type_sources:
        found = response.type_description
        for each in (found.type_description, *found.referenced_type_descriptions):
            source = zero("type_description_interfaces/msg/TypeSource")
            source.type_name, source.encoding = each.type_name, "dynamic"
            response.type_sources.append(source)
    return response
