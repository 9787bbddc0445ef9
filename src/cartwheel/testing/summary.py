"""Messages in a few lines, for the report of a failed test."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from cartwheel.messages.field import Field
from cartwheel.messages.fields import fields

_SHOWN = 8
"""Maximum length of arrays that are shown completely."""
_LONGEST = 200
"""Characters of a text."""


def summary(message: Any) -> list[str]:
    """The lines of a message, without its header and its covariances.

    Messages of numbers, such as vectors, take one line. Of long arrays, the length and the smallest
    and largest number are shown.
    """
    return list(_lines(message, ""))


def _lines(message: Any, indent: str) -> Iterator[str]:
    for field in fields(message.__msgtype__):
        if field.type == "std_msgs/msg/Header" or field.name.endswith("covariance"):
            continue
        value = getattr(message, field.name)
        if field.kind != "message" or field.array:
            yield f"{indent}{field.name}: {_value(field, value)}"
        elif _is_flat(value):
            parts = (
                f"{each.name} {_value(each, getattr(value, each.name))}"
                for each in fields(value.__msgtype__)
            )
            yield f"{indent}{field.name}: {', '.join(parts)}"
        elif inner := list(_lines(value, f"{indent}  ")):
            yield f"{indent}{field.name}:"
            yield from inner


def _is_flat(message: Any) -> bool:
    """Whether a message contains only numbers and short texts."""
    return not any(each.array or each.kind == "message" for each in fields(message.__msgtype__))


def _value(field: Field, value: Any) -> str:
    if not field.array:
        return _one(value)
    if field.kind == "message":
        return f"{len(value)} x {field.type}"
    if len(value) <= _SHOWN:
        return f"[{', '.join(map(_one, np.asarray(value).tolist()))}]"
    if field.kind == "string":
        return f"{len(value)} texts"
    numbers = np.asarray(value)
    known = numbers[np.isfinite(numbers)]
    if not known.size:
        return f"{len(value)} numbers, none of them finite"
    return f"{len(value)} numbers, {_one(known.min().item())} to {_one(known.max().item())}"


def _one(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:.6g}"
    text = str(value)
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}… ({len(text)} characters)"
