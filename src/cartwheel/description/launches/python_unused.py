"""Actions that launch files in Python make, but do not return, so that launch never starts them."""

from __future__ import annotations

import ast
from collections.abc import Collection, Iterator

from cartwheel.description.launches.effort import Effort
from cartwheel.description.launches.python_actions import name_of

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
