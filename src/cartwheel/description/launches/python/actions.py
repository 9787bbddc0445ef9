"""Actions and functions that launch files in Python define before they use them, if they do."""

from __future__ import annotations

import ast
from collections.abc import Callable, Collection, Iterator
from typing import Any

from cartwheel.description.launches.effort import LONGEST, Effort
from cartwheel.description.launches.python_values import NOTHING

_ACTIONS = frozenset(
    {
        "ComposableNodeContainer",
        "ExecuteLocal",
        "ExecuteProcess",
        "GroupAction",
        "IncludeLaunchDescription",
        "LaunchDescription",
        "LifecycleNode",
        "LoadComposableNodes",
        "Node",
        "OnExecutionComplete",
        "OnProcessExit",
        "OnProcessIO",
        "OnProcessStart",
        "OnShutdown",
        "OpaqueFunction",
        "RegisterEventHandler",
        "RosGzBridge",
        "TimerAction",
    }
)
"""Classes of launch and launch_ros that have an effect only if launch visits their objects."""
_WATCHED = "target_action"
"""The argument of event handlers that waits for an action without starting it."""
_ALL_NAMES = frozenset({"eval", "exec", "globals", "locals", "vars"})
"""Functions that may read any variable."""


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


def unused_actions(tree: ast.Module, effort: Effort) -> frozenset[ast.stmt]:
    """The statements that make actions, or lists, which nothing reads.

    A name that the file reads anywhere counts as read, except in other statements of this kind, and
    as the action for which an event handler waits.
    """
    made: dict[ast.stmt, str] = {}
    """The statements that assign an action or a list, with their variables."""
    for each in ast.walk(tree):
        effort.spend()
        if isinstance(each, ast.Name) and each.id in _ALL_NAMES:
            return frozenset()
        if isinstance(each, ast.stmt) and (name := _variable(each)) is not None:
            made[each] = name
    makers: dict[str, list[ast.stmt]] = {}
    for each, name in made.items():
        makers.setdefault(name, []).append(each)
    waiting = list(_reads(tree, effort, without=made))
    while waiting:
        for each in makers.pop(waiting.pop(), ()):
            waiting += _reads(each, effort)
    return frozenset(each for unread in makers.values() for each in unread)


def _variable(statement: ast.stmt) -> str | None:
    """The variable to which a statement assigns an action or a list."""
    if not isinstance(statement, ast.Assign | ast.AnnAssign):
        return None
    value = statement.value
    is_action = isinstance(value, ast.Call) and name_of(value.func) in _ACTIONS
    if not is_action and not isinstance(value, ast.List | ast.Tuple):
        return None
    targets = statement.targets if isinstance(statement, ast.Assign) else [statement.target]
    return targets[0].id if len(targets) == 1 and isinstance(targets[0], ast.Name) else None


def _reads(node: ast.AST, effort: Effort, *, without: Collection[ast.AST] = ()) -> Iterator[str]:
    """The names of variables and attributes that a part of a file reads, without some parts."""
    waiting: list[ast.AST] = [node]
    while waiting:
        each = waiting.pop()
        effort.spend()
        if isinstance(each, ast.Name) and isinstance(each.ctx, ast.Load):
            yield each.id
        elif isinstance(each, ast.Attribute):
            yield each.attr
        if not (isinstance(each, ast.keyword) and each.arg == _WATCHED) and each not in without:
            waiting.extend(ast.iter_child_nodes(each))
