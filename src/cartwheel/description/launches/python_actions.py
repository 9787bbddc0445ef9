"""Actions and functions that launch files in Python define before they use them."""

from __future__ import annotations

import ast
from collections.abc import Callable
from typing import Any

from cartwheel.description.launches.effort import LONGEST
from cartwheel.description.launches.python_values import NOTHING


class Later:
    """An action that is assigned to a variable, and starts where the variable is used.

    Args:
        make: Starts it.
        space: The namespace in which it is assigned.
    """

    def __init__(self, make: Callable[[], Any], space: str) -> None:
        self._make = make
        self.space = space
        self.skipped = False
        """Whether only actions that are not executed contain it."""
        self._is_started = False

    def start(self) -> Any:
        """Starts the action once."""
        if not self._is_started:
            self._is_started = True
            self._make()
        return NOTHING


def used(value: Any) -> Any:
    """The value of a variable or of a list's element that is used; an action is started."""
    return value.start() if isinstance(value, Later) else value


def start_all(values: Any) -> None:
    """Starts the actions in a list that an action contains."""
    for each in values[:LONGEST] if isinstance(values, list) else ():
        used(each)


def name_of(function: ast.expr) -> str:
    """The name of a function or method; empty for other expressions."""
    if isinstance(function, ast.Attribute):
        return function.attr
    return function.id if isinstance(function, ast.Name) else ""


def called_functions(tree: ast.Module) -> dict[str, ast.FunctionDef]:
    """The functions of a file that the file calls with arguments, by name."""
    names = set()
    defined = {}
    for each in ast.walk(tree):
        if isinstance(each, ast.FunctionDef):
            defined[each.name] = each
        elif isinstance(each, ast.Call):
            if isinstance(each.func, ast.Name):
                names.add(each.func.id)
            if name_of(each.func) == "OpaqueFunction" and any(
                word.arg in ("args", "kwargs") for word in each.keywords
            ):
                names |= {
                    word.value.id
                    for word in each.keywords
                    if word.arg == "function" and isinstance(word.value, ast.Name)
                }
    return {name: function for name, function in defined.items() if name in names}


def certain_functions(tree: ast.Module) -> frozenset[str]:
    """The names of functions of a launch file that launch certainly calls: that which returns the
    launch description, and those that actions without a condition name.
    """
    named: set[str] = {"generate_launch_description"}
    doubtful: set[str] = set()
    for each in ast.walk(tree):
        if isinstance(each, ast.Call) and name_of(each.func) == "OpaqueFunction":
            words = {word.arg: word.value for word in each.keywords}
            function = words.get("function", each.args[0] if each.args else None)
            if isinstance(function, ast.Name):
                (doubtful if "condition" in words else named).add(function.id)
    return frozenset(named - doubtful)
