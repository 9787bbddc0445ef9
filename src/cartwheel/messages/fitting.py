"""Generated functions that test whether the values of a message have the types of its fields."""

from __future__ import annotations

import functools
import keyword
from collections.abc import Callable
from typing import Any

import msgspec
import numpy as np

from cartwheel.messages.field import Field
from cartwheel.messages.fields import fields
from cartwheel.messages.singles import is_single
from cartwheel.messages.store import message_class

Test = Callable[[Any], bool]

_FLOATS = frozenset({float, np.float64})
"""Types of numbers that are values of a ``float64`` as they are."""


def fits(message: Any) -> bool:
    """Whether a message can be published as it is.

    If not, its values may still be valid: a whole number for a ``float64``, or a list of numbers
    instead of an array. Numbers outside of the range of their type do not fit.
    """
    cls: Any = type(message)
    return _test(cls)(message)


@functools.lru_cache(1024)
def _test(cls: Any) -> Test:
    """The test of a class. A call takes less than a microsecond for a message without lists."""
    known = fields(cls.__msgtype__)
    if not issubclass(cls, msgspec.Struct) or any(keyword.iskeyword(each.name) for each in known):
        return _never
    names: dict[str, Any] = {"array": np.ndarray, "FLOATS": _FLOATS}
    tests = [_condition(field, index, names) for index, field in enumerate(known)]
    text = f"def test(m):\n    return {' and '.join(tests) or 'True'}"
    exec(text, names)  # noqa: S102 - the names in it are identifiers
    test: Test = names["test"]
    return test


def _condition(field: Field, index: int, names: dict[str, Any]) -> str:
    """The source text of the test of a field.

    Args:
        field: The field.
        index: Its number, for the names of the variables.
        names: The global names of the text, to which those of the test are added.
    """
    value = f"m.{field.name}"
    if field.kind == "message":
        cls = message_class(field.type)
        names[f"class{index}"], names[f"test{index}"] = cls, _test(cls)
    if not field.array:
        return _single(field, index, value, names)
    held = f"v{index}"
    if field.kind in ("message", "string"):
        parts = [f"type({held} := {value}) is list"]
        parts.append(f"all([{_single(field, index, 'each', names)} for each in {held}])")
    else:
        names[f"dtype{index}"] = np.dtype(field.type)
        parts = [f"type({held} := {value}) is array", f"{held}.dtype == dtype{index}"]
        parts.append(f"{held}.ndim == 1")
    if field.length is not None:
        parts.append(f"len({held}) == {field.length}")
    elif field.most:
        parts.append(f"len({held}) <= {field.most}")
    return " and ".join(parts)


def _single(field: Field, index: int, value: str, names: dict[str, Any]) -> str:
    if field.kind == "message":
        held = f"w{index}"
        return f"type({held} := {value}) is class{index} and test{index}({held})"
    if field.type == "float32":
        held = f"w{index}"
        names["is_single"] = is_single
        return f"type({held} := {value}) in FLOATS and is_single({held})"
    if field.kind == "float":
        return f"type({value}) in FLOATS"
    if field.kind == "int":
        limits = np.iinfo(field.type)
        held = f"w{index}"
        return f"type({held} := {value}) is int and {limits.min} <= {held} <= {limits.max}"
    if field.kind == "bool":
        return f"type({value}) is bool"
    held = f"w{index}"
    longest = f" and len({held}) <= {field.longest}" if field.longest else ""
    return f"type({held} := {value}) is str{longest}"


def _never(_: Any) -> bool:
    return False
