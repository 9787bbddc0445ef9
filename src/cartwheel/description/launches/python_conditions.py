"""Conditions and comparisons in launch files in Python."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from cartwheel.description.launches.effort import UNKNOWN
from cartwheel.description.launches.python_values import NOTHING, joined

_VALUES = {"true": True, "1": True, "false": False, "0": False}
CONDITIONS: Mapping[str, Callable[..., bool]] = {
    "IfCondition": lambda value: value,
    "UnlessCondition": lambda value: not value,
    "NotSubstitution": lambda value: not value,
    "AndSubstitution": lambda one, other: one and other,
    "OrSubstitution": lambda one, other: one or other,
    "EqualsSubstitution": lambda one, other: one == other,
    "NotEqualsSubstitution": lambda one, other: one != other,
}
"""Classes of launch, by what they return."""
_OF_TEXTS = frozenset({"EqualsSubstitution", "NotEqualsSubstitution"})


def holds(name: str, values: list[Any]) -> Any:
    """Whether a condition holds; `NOTHING` if that is unknown.

    Args:
        name: One of `CONDITIONS`.
        values: Its arguments.
    """
    texts = [joined(each) for each in values]
    known: list[Any] = [*texts] if name in _OF_TEXTS else [_truth(each) for each in texts]
    condition = CONDITIONS[name]
    if any(each is None for each in known) or any(UNKNOWN in each for each in texts):
        return NOTHING
    try:
        return condition(*known)
    except TypeError:
        return NOTHING  # a number of arguments that launch rejects


def _truth(text: str) -> bool | None:
    return _VALUES.get(text.strip().lower())
