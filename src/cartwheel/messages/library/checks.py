"""Checks of types with their nested types: order, nesting depth and size."""

from __future__ import annotations

from typing import NoReturn

from cartwheel.codes.graph import MESSAGE_DEFINITION_INVALID
from cartwheel.errors import GraphError, Origin
from cartwheel.messages.definition import Definition
from cartwheel.messages.learnt import learnt, recorded
from cartwheel.messages.store import loaded, message_class

MOST_ELEMENTS = 20_000
"""Maximum number of messages, strings and numbers in a type with empty sequences."""
MOST_BYTES = 64 << 20
"""Maximum size of the fixed arrays of numbers in a type."""
MOST_LEVELS = 50
"""Maximum nesting depth of messages."""


def nested_first(read: dict[str, Definition]) -> list[Definition]:
    """Sorts definitions so that nested types come first.

    Raises:
        GraphError: A type contains itself, or is nested too deeply.
    """
    ordered: list[Definition] = []
    done: set[str] = set()
    left = dict(read)
    for _ in range(MOST_LEVELS):
        flat = [
            each
            for each in left.values()
            if all(used.type in done or used.type not in read for used in each.uses)
        ]
        ordered += flat
        done.update(each.name for each in flat)
        left = {name: each for name, each in left.items() if name not in done}
        if not left or not flat:
            break
    if left:
        one = min(left.values(), key=lambda each: each.name)
        used = next(used for used in one.uses if used.type in left)
        reject(
            one,
            f'the type contains itself in the field "{used.name}"'
            if not flat
            else f"messages are nested more than {MOST_LEVELS} times",
            used.line,
            field=used.name,
        )
    return ordered


def check_sizes(ordered: list[Definition]) -> None:
    """Rejects types whose messages are large even with empty sequences."""
    sizes: dict[str, tuple[int, int]] = {}
    for each in ordered:
        elements, size = 1, 0
        for field in each.fields:
            count = field.length if field.length is not None else 0 if field.array else 1
            if field.is_message:
                # Built-in types are small.
                inner, content = sizes.get(field.type) or _bundled_size(field.type)
                elements += 1 + count * inner
                size += count * content
            elif field.is_text or not field.array:
                elements += max(count, 1)
            else:
                elements += 1
                size += count * 8
            if elements > MOST_ELEMENTS or size > MOST_BYTES:
                reject(
                    each,
                    f"a message has more than {MOST_ELEMENTS} fields (including nested messages), "
                    f"or arrays of more than {MOST_BYTES} bytes",
                    field.line,
                    field=field.name,
                )
        sizes[each.name] = elements, size


def _bundled_size(name: str) -> tuple[int, int]:
    known = learnt(name)
    if known is None:
        message_class(name)
        known = recorded(name, loaded().fielddefs[name])
    elements, size = 1, 0
    for field in known.fields:
        count = field.length if field.length is not None else 0 if field.array else 1
        inner, content = _bundled_size(field.type) if field.is_message else (1, 8)
        elements += count * inner if field.is_message or field.is_text else 1
        size += count * content
    return elements, size


def reject(
    definition: Definition, message: str, line: int, *, hint: str | None = None, **values: str
) -> NoReturn:
    """Raises the error for a definition, with a line of its file."""
    raise GraphError(
        message,
        code=MESSAGE_DEFINITION_INVALID,
        origin=Origin(file=definition.origin.file, line=line),
        hint=hint,
        values={"type": definition.name, **values},
    )
