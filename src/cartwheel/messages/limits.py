"""Limits for numbers in commands."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Iterator
from operator import attrgetter
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
    values = _flat(message.__msgtype__)
    # A sum is faster than comparisons. It is NaN or too large if one of the numbers is.
    if values is not None and sum(map(abs, values(message))) <= most:
        return ""
    return _unfit(message, most, unset, "")


@functools.cache
def _flat(type_name: str) -> Callable[[Any], tuple[float, ...]] | None:
    """Returns all floating-point numbers of a message; None if some are in arrays, or too few."""
    names = list(_names(type_name))
    if len(names) < 2 or None in names:
        return None
    return attrgetter(*(name for name in names if name is not None))


def _names(type_name: str) -> Iterator[str | None]:
    """Names of the floating-point numbers; None is an array."""
    for field in _with_numbers(type_name):
        if field.array:
            yield None
        elif field.kind == "float":
            yield field.name
        else:
            for name in _names(field.type):
                yield None if name is None else f"{field.name}.{name}"


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
