"""Parameters of ROS 2's nodes as messages."""

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
"""Where a value of each type stands. Source: rcl_interfaces, ParameterType."""
_TYPES: dict[type, int] = {bool: 1, int: 2, float: 3, str: 4}
_OF_ARRAYS = 5
"""What the type of an array is above that of its elements."""


def parameter_type(value: Any) -> int:
    """The number of a value's type; that of no value where ROS 2 has none such.

    Args:
        value: A bool, int, float, str, or a list of one of them.
    """
    if not isinstance(value, list | tuple):
        return _TYPES.get(type(value), NOT_SET)
    kinds = {type(each) for each in value}
    if kinds == {int, float}:
        kinds = {float}
    found = _TYPES.get(kinds.pop(), NOT_SET) if len(kinds) == 1 else NOT_SET
    return found and found + _OF_ARRAYS


def parameter_value(value: Any) -> Any:
    """``ParameterValue`` of what `parameter_type` knows; one that is not set for anything else."""
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
    """``ListParametersResult``: the names below some prefixes, or below nothing.

    Args:
        names: Of all parameters, with dots.
        prefixes: Those that are asked for; all names where there are none.
        depth: How many parts a name may have below its prefix; 0 for any number.
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
    """What of a name comes below one of the prefixes; all of it where there are none."""
    if not prefixes:
        return name
    for prefix in prefixes:
        if name == prefix:
            return ""
        if name.startswith(f"{prefix}."):
            return name[len(prefix) + 1 :]
    return None
