"""Single numbers of messages by the names of their fields."""

from __future__ import annotations

import copy
import dataclasses
import re
from collections.abc import Callable, Iterable
from operator import attrgetter
from typing import Any, TypeVar

import numpy as np

from cartwheel.arrays.data import Array, full_kind_of
from cartwheel.codes.graph import FIELD_UNKNOWN
from cartwheel.errors import GraphError
from cartwheel.similar_names import meant, suggestion

_PART = re.compile(r"([A-Za-z]\w*)((?:\[-?\d{1,9}\])*)")
_RANGE = re.compile(r"\[(-?\d{1,9})?:(-?\d{1,9})?(?::(\d{1,9})?)?\]$")
"""A part of an array, as in Python, at the end of a name."""
_LISTED = 5
"""Number of fields that a hint names."""
_INDEX = re.compile(r"-?\d+")
_LONGEST = 10**9
"""More elements than an array has."""
_Steps = list[str | int | slice]
T = TypeVar("T")


class _Absent(float):
    """NaN for an index, or a part, after the end of an array of numbers that is not empty."""

    length: int


def values(messages: Iterable[Any], field: str) -> Array:
    """One number or one array of each message.

    Args:
        messages: Messages of one type.
        field: Names joined with dots, with indices of arrays: ``pose.pose.position.x``,
            ``ranges[90]``. A part of an array is ``ranges[:90]``, ``ranges[-90:]`` or
            ``ranges[::10]``, as in Python. A time or a duration, such as ``header.stamp``, is in s.

    Returns:
        Shape (n,), float64; NaN where an array of a message has no such index. For a field that is
        an array of numbers, such as ``ranges``, shape (n, m), where m is the size of the longest
        array; NaN after the end of the others.

    Raises:
        GraphError: The type does not have the field, or the field is not a number or an array of
            numbers, or the name of the field is not a text, or the arrays of numbers in all
            messages end before the index.
    """
    steps = _steps(field)
    found = [_value(message, field, steps) for message in messages]
    if found and all(isinstance(each, _Absent) for each in found):
        raise _ends(field, found)
    rows = [each for each in found if isinstance(each, np.ndarray)]
    if not rows:
        return np.array(found, dtype=float)
    table = np.full((len(found), max(row.size for row in rows)), np.nan)
    for line, row in zip(table, rows, strict=True):
        line[: row.size] = row
    return table


def reader(field: str) -> Callable[[Any], float | Array]:
    """Returns a function that reads a field of a message, as `values` does, but faster.

    Args:
        field: See `values`.

    Raises:
        GraphError: The name is invalid. The function raises the other errors of `values`.
    """
    steps = _steps(field)
    if not all(isinstance(step, str) for step in steps):
        return lambda message: _present(_value(message, field, steps), field)
    get, known = attrgetter(field), None

    def read(message: Any) -> float | Array:
        nonlocal known
        if type(message) is known:
            value = get(message)
            if type(value) is float:
                return value
        found = _value(message, field, steps)
        known = type(message)
        return found

    return read


def single(message: Any, field: str) -> float | str | bool:
    """A number, a text or a truth value in a message; see `values`.

    Raises:
        GraphError: As for `values`, or the field is an array.
    """
    found = _present(_found(message, field, _steps(field)), field)
    if isinstance(found, bool | str):
        return found
    value = _number(found, field)
    if isinstance(value, np.ndarray):
        name = _RANGE.sub("", field)
        raise _unknown(f'the field "{field}" is an array', field, f"Write {name}[0].")
    return value


def with_changed(message: Any, field: str, change: Callable[[Array], Array]) -> Any:
    """A copy of a message with other numbers in a field; parts that are equal are shared.

    Args:
        message: The message.
        field: As for `values`, without times.
        change: Receives the numbers as float64, shape () or (n,), and returns as many. Results for
            fields of integers are rounded and limited to their range.

    Raises:
        GraphError: As for `values`, or the field is a time.
    """
    steps = _steps(field)
    _present(_value(message, field, steps), field)
    return _rebuilt(message, steps, change, field)


def _rebuilt(value: Any, steps: _Steps, change: Callable[[Array], Array], field: str) -> Any:
    if steps:
        step = steps[0]
        if isinstance(step, str):
            made = _rebuilt(getattr(value, step), steps[1:], change, field)
            return dataclasses.replace(value, **{step: made})
        copied = copy.copy(value)
        if isinstance(step, slice) or -len(value) <= step < len(value):
            copied[step] = _rebuilt(value[step], steps[1:], change, field)
        return copied
    if hasattr(value, "nanosec"):
        raise _unknown(f'the field "{field}" is a time', field)
    numbers = np.asarray(value)
    made = np.asarray(change(numbers.astype(float)))
    if numbers.dtype.kind in "iu":
        limits = np.iinfo(numbers.dtype)
        made = np.clip(np.rint(made), limits.min, limits.max)
    made = made.astype(numbers.dtype)
    return made if isinstance(value, np.ndarray) else made.tolist()


def _steps(field: str) -> _Steps:
    if not isinstance(field, str):
        raise _unknown(f"a field must be named by a text (got {field!r:.60})", f"{field!r:.60}")
    steps: _Steps = []
    part_of_array = _RANGE.search(field)
    for part in field[: part_of_array.start() if part_of_array else None].split("."):
        match = _PART.fullmatch(part)
        if match is None:
            hint = "Examples are position[0], ranges[:90] and ranges[::10]." * ("[" in field)
            raise _unknown(f'"{field}" is not the name of a field', field, hint or None)
        steps += [match[1], *map(int, _INDEX.findall(match[2]))]
    if part_of_array:
        start, stop, step = (int(each) if each else None for each in part_of_array.groups())
        if step == 0 or not range(_LONGEST)[start:stop:step]:
            raise _unknown(f'"{field}" contains no element of an array', field)
        steps.append(slice(start, stop, step))
    return steps


def _found(message: Any, field: str, steps: _Steps) -> Any:
    value = message
    for step in steps:
        if isinstance(step, str):
            known = getattr(value, "__dataclass_fields__", ())
            if step not in known:
                raise _not_in(value, step, list(known), field)
            value = getattr(value, step)
        elif not isinstance(value, str) and hasattr(value, "__len__"):
            length = len(value)
            inside = range(length)[step] if isinstance(step, slice) else -length <= step < length
            if not inside and length and isinstance(value, np.ndarray):
                absent = _Absent("nan")
                absent.length = length
                return absent
            if not inside and isinstance(step, int):
                return float("nan")
            value = value[step]
        else:
            raise _unknown(f'an index of "{field}" follows a field that is not an array', field)
    return value


def _value(message: Any, field: str, steps: _Steps) -> float | Array:
    return _number(_found(message, field, steps), field)


def _number(value: Any, field: str) -> float | Array:
    """A value of a message as a number or numbers."""
    if isinstance(value, _Absent):
        return value
    if hasattr(value, "nanosec"):
        return float(value.sec + value.nanosec * 1e-9)
    if isinstance(value, bool | int | float | np.bool_ | np.number):
        return float(value)
    if not isinstance(value, str | bytes) and hasattr(value, "__len__"):
        numbers = np.asarray(value)
        if numbers.ndim == 1 and (numbers.dtype.kind in "biuf" or not numbers.size):
            return numbers.astype(float)
    raise _unknown(
        f'the field "{field}" is not a number or an array of numbers',
        field,
        _inner(value, _RANGE.sub("", field)),
    )


def _inner(value: Any, field: str) -> str | None:
    """The hint for a field whose value contains messages."""
    if not isinstance(value, str | bytes) and hasattr(value, "__len__"):
        if not len(value) or not hasattr(value[0], "__msgtype__"):
            return f"Numbers of an array of messages are named so: {field}[0].name."
        value, field = value[0], f"{field}[0]"
    fields = getattr(value, "__dataclass_fields__", ())
    names = [name for name in fields if not isinstance(getattr(value, name), str | bytes)]
    return f"Write {', '.join(f'{field}.{name}' for name in names[:_LISTED])}." if names else None


def _not_in(value: Any, step: str, known: list[str], field: str) -> GraphError:
    owner = full_kind_of(value) if hasattr(value, "__msgtype__") else "a number or list"
    of = "" if step == field else f' of "{field}"'
    return GraphError(
        f'{owner} does not have the field "{step}"{of}',
        code=FIELD_UNKNOWN,
        hint=suggestion(step, known) if known else None,
        values={"field": field, "meant": meant(step, known)},
    )


def _present(value: T, field: str) -> T:
    """A value, unless its index is after the end of the array."""
    if isinstance(value, _Absent):
        raise _ends(field, [value])
    return value


def _ends(field: str, found: Iterable[Any]) -> GraphError:
    """The error of an index after the end of arrays."""
    length = max(each.length for each in found)
    return _unknown(
        f'the array of "{field}" has only {length} element{"s" if length > 1 else ""}',
        field,
        f"The last one has the index {length - 1}.",
        length=length,
    )


def _unknown(message: str, field: str, hint: str | None = None, **more: int) -> GraphError:
    return GraphError(message, code=FIELD_UNKNOWN, hint=hint, values={"field": field, **more})
