"""Evaluates expressions for one expansion, within its limits."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from cartwheel.description.expressions.budget import Budget, ExpressionError
from cartwheel.description.expressions.functions import CLASSES, Function, sort
from cartwheel.description.expressions.operations import methods_of
from cartwheel.description.expressions.scope import Lambda, Scope, entry, not_allowed
from cartwheel.description.expressions.syntax import compiled

MAX_CALLS = 30
"""Maximum depth of nested lambda calls."""


class Evaluator:
    """Evaluates expressions for one expansion.

    Args:
        budget: The shared limits.
        namespace: Type of xacro's tables, whose entries are read as attributes.
        dotted: Type of the dicts whose values are read as attributes.
    """

    def __init__(self, budget: Budget, *, namespace: type, dotted: type) -> None:
        self.budget = budget
        self.namespace = namespace
        self.dotted = dotted
        budget.opaque = (namespace,)
        self._calls = 0

    def evaluate(self, text: str, names: Mapping[str, Any]) -> Any:
        """The value of an expression.

        Args:
            text: The expression, in Python's syntax.
            names: The values of its names.

        Raises:
            ExpressionError: The expression is not allowed, or its value is too large.
            SyntaxError: The text is not an expression.
            Exception: Errors of the operation itself, such as ZeroDivisionError or TypeError.
        """
        self.budget.spend()
        value = compiled(text.strip())(Scope(self, names, {}))
        if type(value) not in (float, int, bool, str):
            self.budget.weigh(value)
        return value

    def call(self, called: Any, args: list[Any], named: dict[str, Any]) -> Any:
        """Calls an allowed function."""
        self.budget.spend()
        found = CLASSES.get(called) if isinstance(called, type) else called
        if isinstance(found, Function):
            return found.run(self, *args, **named)
        if isinstance(found, Lambda):
            if self._calls >= MAX_CALLS:
                raise ExpressionError(
                    f"lambda calls are nested more than {MAX_CALLS} levels deep",
                    values={"kind": "lambda", "most": MAX_CALLS},
                )
            self._calls += 1
            try:
                return found.run(args, named)
            finally:
                self._calls -= 1
        kind = type(called).__name__
        raise ExpressionError(f"a value of type {kind} cannot be called", values={"refused": kind})

    def method(self, value: Any, name: str, args: list[Any], named: dict[str, Any]) -> Any:
        """Calls a method of a value, or a function of a namespace."""
        if isinstance(value, self.namespace):
            return self.call(self.attribute(value, name), args, named)
        self.budget.spend()
        if isinstance(value, list) and name == "sort":
            return sort(self, value, *args, **named)
        known = methods_of(value)
        if isinstance(value, str):
            self.budget.spend(len(value) // 500)
        if name in known:
            return self.budget.result(known[name](self.budget, value, *args, **named))
        if isinstance(value, self.dotted) and not hasattr(dict, name):
            return self.call(self.attribute(value, name), args, named)
        raise not_allowed(
            f"{type(value).__name__}.{name}()",
            hint=f"Allowed methods: {', '.join(sorted(known))}." if known else None,
        )

    def attribute(self, value: Any, name: str) -> Any:
        """An entry of a namespace, or of a dict from YAML."""
        if name.startswith("_"):
            raise not_allowed(f'"{name}"')
        if isinstance(value, self.namespace):
            return entry(value, name)
        if isinstance(value, self.dotted) and not hasattr(dict, name):
            return getattr(value, name)
        if isinstance(value, int | float | complex) and name in ("real", "imag"):
            return getattr(value, name)
        raise not_allowed(
            f'"{type(value).__name__}.{name}"',
            hint=f"Call it: .{name}(…)." if name in methods_of(value) else None,
        )
