"""Limits for numbers in commands."""

from __future__ import annotations

import functools
import math
from typing import Any

import numpy as np

from cartwheel.messages.field import Field
from cartwheel.messages.fields import fields


def unfit(message: Any, *, most: float, unset: bool = False) -> str:
    """Describes the first number that is not finite or too large. Empty if all numbers are valid.

    Args:
        message: Instance of a class from `message_class`.
        most: Maximum absolute value.
        unset: Whether to allow NaN and infinity, which mean "not set" in ros2_control.
    """
    return _unfit(message, most, unset, "")


@functools.cache
def _with_numbers(type_name: str) -> tuple[Field, ...]:
    """Fields of a type that are floating-point numbers or contain some."""
    return tuple(
        field
        for field in fields(type_name)
        if field.kind == "float" or (field.kind == "message" and _with_numbers(field.type))
    )


def _unfit(message: Any, most: float, unset: bool, path: str) -> str:
    for field in _with_numbers(message.__msgtype__):
        value = getattr(message, field.name)
        place = f"{path}{field.name}"
        if field.kind == "message":
            for each in value if field.array else (value,):
                if found := _unfit(each, most, unset, f"{place}."):
                    return found
        elif field.array:
            if len(value) and not _all_fit(np.asarray(value, dtype=float), most, unset):
                return f"{place} contains a number that"
        elif not abs(value) <= most and not (unset and not math.isfinite(value)):
            return f"{place} is {value:g}, which"
    return ""


def _all_fit(values: Any, most: float, unset: bool) -> bool:
    fit = np.abs(values) <= most
    if unset:
        fit |= ~np.isfinite(values)
    return bool(fit.all())
