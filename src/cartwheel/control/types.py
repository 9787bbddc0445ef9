"""Definitions of message types in the control protocol."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from cartwheel.errors import Origin
from cartwheel.messages.learnt import needed, register
from cartwheel.messages.library.parsing import parse_definition


def packed_types(name: str) -> list[dict[str, Any]]:
    """The definitions that a client needs for a message or service type, nested ones first."""
    return [
        {
            "name": each.name,
            "dialect": each.dialect,
            "text": each.text,
            "file": each.origin.file,
            "line": each.origin.line,
            "own_header": any(used.type.endswith("/msg/Header") for used in each.uses)
            and not any(used.type == "std_msgs/msg/Header" for used in each.uses),
        }
        for each in needed(name)
    ]


def register_types(packed: Sequence[dict[str, Any]]) -> None:
    """Registers the types that a simulation has sent."""
    register(
        parse_definition(
            each["name"],
            each["text"],
            Origin(file=each["file"], line=each["line"]),
            dialect=None if each["dialect"] == "both" else each["dialect"],
            own_header=each["own_header"],
        )
        for each in packed
    )
