"""Conditions and comparisons in launch files in Python."""

from __future__ import annotations

import ast
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from cartwheel.description.launches.effort import UNKNOWN
from cartwheel.description.launches.python_values import NOTHING, is_known, joined

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


def compared(sign: ast.cmpop, left: Any, right: Any) -> bool | None:
    """Whether a comparison of texts, or with a constant, holds; None if that is unknown."""
    if isinstance(sign, ast.Is | ast.IsNot) and (right is None or isinstance(right, bool)):
        return None if left is NOTHING else (left is right) == isinstance(sign, ast.Is)
    plain = is_known(left, right) or (isinstance(left, bool) and isinstance(right, bool))
    if isinstance(sign, ast.Eq | ast.NotEq) and plain:
        return bool(left == right) == isinstance(sign, ast.Eq)
    within = isinstance(sign, ast.In | ast.NotIn) and isinstance(right, list)
    if within and is_known(*right) and (left is None or is_known(left)):
        return (left in right) == isinstance(sign, ast.In)
    return None


def connected(sign: ast.boolop, parts: Sequence[bool | None]) -> bool | None:
    """Whether conditions that ``and`` or ``or`` connects hold; None if that is unknown."""
    decides = isinstance(sign, ast.Or)
    if decides in parts:
        return decides
    return None if None in parts else not decides


def _truth(text: str) -> bool | None:
    return _VALUES.get(text.strip().lower())
