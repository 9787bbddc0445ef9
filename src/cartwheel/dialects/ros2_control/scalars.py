"""The types that ROS 2 gives to the values in parameter files. Source: rcl_yaml_param_parser."""

from __future__ import annotations

import re
from typing import Any

_BOOLS = frozenset(
    word
    for plain in ("y", "yes", "true", "on", "n", "no", "false", "off")
    for word in (plain, plain.capitalize(), plain.upper())
)
_INTEGER = re.compile(r"[-+]?(?:0[xX][0-9a-fA-F]+|0[0-7]*|[1-9][0-9]*)")
_DOUBLE = re.compile(r"[-+]?(?:(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|\.?(?:inf|nan))", re.IGNORECASE)
_LONGEST = 18
"""Digits of an integer that certainly fits into 64 bits."""


def type_of(node: Any) -> str:
    """The type of a value: ``double``, ``integer``, ``bool`` or ``string``, or one of them with
    ``_array`` for a list.

    Empty if it is unknown, for a list with values of several types, and for an empty list.

    Args:
        node: A node of a composed YAML file.
    """
    if node.id == "sequence":
        types = {type_of(each) if each.id == "scalar" else "" for each in node.value}
        return f"{types.pop()}_array" if len(types) == 1 and "" not in types else ""
    if node.id != "scalar":
        return ""
    return scalar_type(node.value, quoted=node.style in ("'", '"'))


def scalar_type(text: str, *, quoted: bool) -> str:
    """The type of a single value; empty if a launch file replaces a part of it."""
    if "$(" in text:
        return ""
    if quoted:
        return "string"
    if text in _BOOLS:
        return "bool"
    if _INTEGER.fullmatch(text):
        return "integer" if len(text) <= _LONGEST else ""
    return "double" if _DOUBLE.fullmatch(text) else "string"
