"""Parameters of ROS 2 nodes as messages."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from cartwheel.messages.convert import zero
from cartwheel.messages.store import message_class

_PACKAGE = "rcl_interfaces/msg"
NOT_SET = 0
FIELDS = {
    1: "bool_value",
    2: "integer_value",
    3: "double_value",
    4: "string_value",
    5: "byte_array_value",
    6: "bool_array_value",
    7: "integer_array_value",
    8: "double_array_value",
    9: "string_array_value",
}
"""Field that contains the value of each type. Source: rcl_interfaces, ParameterType."""
_TYPES: dict[type, int] = {bool: 1, int: 2, float: 3, str: 4}
_OF_ARRAYS = 5
"""Difference between the type number of an array and that of its elements."""


def parameter_type(value: Any) -> int:
    """The type number of a value, or "not set" if ROS 2 has no such type.

    Args:
        value: bool, int, float, str, or a list of one of these types.
    """
    if not isinstance(value, list | tuple):
        return _TYPES.get(type(value), NOT_SET)
    kinds = {type(each) for each in value}
    if kinds == {int, float}:
        kinds = {float}
    found = _TYPES.get(kinds.pop(), NOT_SET) if len(kinds) == 1 else NOT_SET
    return found and found + _OF_ARRAYS


def parameter_value(value: Any) -> Any:
    """Converts a value to ``ParameterValue``. Unsupported values become "not set"."""
    made = zero(f"{_PACKAGE}/ParameterValue")
    made.type = parameter_type(value)
    if made.type:
        field = FIELDS[made.type]
        empty = getattr(made, field)
        if isinstance(empty, np.ndarray):
            value = np.array(value, empty.dtype)
        setattr(made, field, list(value) if isinstance(value, tuple) else value)
    return made


def listed(names: Iterable[str], prefixes: Sequence[str], depth: int) -> Any:
    """``ListParametersResult``: the names below some prefixes, or all names.

    Args:
        names: Names of all parameters, separated by dots.
        prefixes: Requested prefixes; empty for all names.
        depth: Maximum number of name parts below a prefix; 0 means no limit.
    """
    found, folders = [], set()
    for name in sorted(names):
        rest = _below(name, prefixes)
        if rest is None or (depth and rest.count(".") >= depth):
            continue
        found.append(name)
        if "." in name:
            folders.add(name.rpartition(".")[0])
    return message_class(f"{_PACKAGE}/ListParametersResult")(names=found, prefixes=sorted(folders))


def _below(name: str, prefixes: Sequence[str]) -> str | None:
    """The part of a name below one of the prefixes, or the whole name if there are no prefixes."""
    if not prefixes:
        return name
    for prefix in prefixes:
        if name == prefix:
            return ""
        if name.startswith(f"{prefix}."):
            return name[len(prefix) + 1 :]
    return None
