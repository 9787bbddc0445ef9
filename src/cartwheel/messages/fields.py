"""Fields of message types, read once per type."""

from __future__ import annotations

import functools
from dataclasses import replace

from cartwheel.messages.classes import FILLER
from cartwheel.messages.defaults import STATED
from cartwheel.messages.field import Field, field_of
from cartwheel.messages.learnt import learnt
from cartwheel.messages.store import loaded, message_class


@functools.cache
def fields(name: str) -> tuple[Field, ...]:
    """Fields of a message type in order, without the filler of an empty message.

    Raises:
        UnknownNameError: The type does not exist.
    """
    full = message_class(name).__msgtype__
    definition = learnt(full)
    defaults = STATED.get(full, {})
    if definition is not None:
        defaults = {field.name: field.default for field in definition.fields}
    return tuple(
        replace(field_of(field, description), default=defaults.get(field))
        for field, description in loaded().fielddefs[full][1]
        if field != FILLER
    )
