"""The names that a part of an expression can use, and lambdas."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from cartwheel.description.expressions.budget import ExpressionError

if TYPE_CHECKING:
    from cartwheel.description.expressions.evaluator import Evaluator


def not_allowed(part: str, *, hint: str | None = None) -> ExpressionError:
    """The error for a part that is not allowed; the value omits the quotes in the message."""
    return ExpressionError(
        f"{part} is not allowed in an expression", hint=hint, values={"refused": part.strip('"')}
    )


def entry(names: Any, name: str) -> Any:
    """The value of a name.

    Raises:
        NameError: The name is not defined.
    """
    try:
        return names[name]
    except KeyError:
        raise NameError(f"name '{name}' is not defined", name=name) from None


@dataclass(slots=True)
class Scope:
    evaluator: Evaluator
    names: Mapping[str, Any]
    local: dict[str, Any]
    """Names in comprehensions and lambdas."""

    def inner(self) -> Scope:
        return Scope(self.evaluator, self.names, dict(self.local))


@dataclass(frozen=True, slots=True, eq=False)
class Lambda:
    run: Callable[[list[Any], dict[str, Any]], Any]
