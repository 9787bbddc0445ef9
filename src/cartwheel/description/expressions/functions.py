"""Python's and math's functions, as expressions may call them."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from cartwheel.description.expressions.budget import ExpressionError
from cartwheel.description.expressions.operations import (
    add,
    filled_dict,
    filled_set,
    multiply,
    snapshot,
)

if TYPE_CHECKING:
    from cartwheel.description.expressions.evaluator import Evaluator

MAX_FACTORIAL = 500
"""Argument of math.factorial; its result has 3,768 bits."""


@dataclass(frozen=True, slots=True, repr=False)
class Function:
    """A function that expressions may call. Its attributes are not accessible."""

    name: str
    run: Callable[..., Any]
    """Takes the evaluator, then the arguments."""

    def __repr__(self) -> str:
        return f"<function {self.name}>"


def function(name: str, plain: Callable[..., Any]) -> Function:
    """A function whose arguments and result are measured against the budget.

    Args:
        name: Name in expressions.
        plain: Python's function.
    """

    def run(evaluator: Evaluator, *args: Any, **named: Any) -> Any:
        budget = evaluator.budget
        for each in (*args, *named.values()):
            budget.weigh(each)
        return budget.result(plain(*args, **named))

    return Function(name, run)


def shallow(name: str, plain: Callable[..., Any]) -> Function:
    """A function that does not read the elements of its arguments, so they are not measured."""
    return Function(name, lambda _, *args, **named: plain(*args, **named))


def _type(_: Evaluator, value: Any) -> type:
    return type(value)


def _map(evaluator: Evaluator, called: Any, *values: Any) -> list[Any]:
    lists = [snapshot(evaluator.budget, each) for each in values]
    return [evaluator.call(called, list(each), {}) for each in zip(*lists, strict=False)]


def _filter(evaluator: Evaluator, called: Any, values: Any) -> list[Any]:
    found = snapshot(evaluator.budget, values)
    if called is None:
        return [each for each in found if each]
    return [each for each in found if evaluator.call(called, [each], {})]


def _zip(evaluator: Evaluator, *values: Any, strict: bool = False) -> list[Any]:
    lists = [snapshot(evaluator.budget, each) for each in values]
    evaluator.budget.items(sum(map(len, lists)))
    return list(zip(*lists, strict=strict))


def _enumerate(evaluator: Evaluator, values: Any, start: int = 0) -> list[Any]:
    return list(enumerate(snapshot(evaluator.budget, values), start))


def _reversed(evaluator: Evaluator, values: Any) -> list[Any]:
    return snapshot(evaluator.budget, values)[::-1]


def _keys(evaluator: Evaluator, found: list[Any], called: Any) -> list[Any]:
    """What values are compared by. They are counted together, as each is compared with several."""
    keys = found if called is None else [evaluator.call(called, [each], {}) for each in found]
    evaluator.budget.weigh(keys)
    return keys


def _sorted(evaluator: Evaluator, values: Any, *, key: Any = None, reverse: Any = False) -> Any:
    found = snapshot(evaluator.budget, values)
    keys = _keys(evaluator, found, key)
    order = sorted(range(len(found)), key=keys.__getitem__, reverse=bool(reverse))
    return [found[index] for index in order]


def sort(evaluator: Evaluator, items: list[Any], *, key: Any = None, reverse: Any = False) -> None:
    """``items.sort()``."""
    items[:] = _sorted(evaluator, items, key=key, reverse=reverse)


def _extreme(name: str, plain: Callable[..., Any]) -> Function:
    def run(evaluator: Evaluator, *args: Any, key: Any = None, **named: Any) -> Any:
        found = snapshot(evaluator.budget, args[0]) if len(args) == 1 else list(args)
        keys = _keys(evaluator, found, key)
        if not found:
            return plain(found, **named)
        return found[plain(range(len(found)), key=keys.__getitem__)]

    return Function(name, run)


def _sum(evaluator: Evaluator, values: Any, start: Any = 0) -> Any:
    total = start
    for each in snapshot(evaluator.budget, values):
        if isinstance(each, str) or isinstance(total, str):
            raise TypeError("sum() can't sum strings [use ''.join(seq) instead]")
        evaluator.budget.spend()
        total = add(evaluator.budget, total, each)
    return total


def _range(evaluator: Evaluator, *args: Any) -> range:
    made = range(*args)
    evaluator.budget.items(len(made))
    return made


def _round(_: Evaluator, value: Any, ndigits: Any = None) -> Any:
    if isinstance(ndigits, int) and abs(ndigits) > 400:
        raise ExpressionError(
            "round() supports at most 400 digits", values={"kind": "round", "most": 400}
        )
    return round(value, ndigits)


def _made(kind: Callable[..., Any]) -> Callable[..., Any]:
    """A container of what is in another."""

    def run(evaluator: Evaluator, *values: Any) -> Any:
        if kind in (set, frozenset) and len(values) == 1:
            return kind(filled_set(evaluator.budget, values[0]))
        return kind(*(snapshot(evaluator.budget, each) for each in values))

    return run


def _dict(evaluator: Evaluator, *values: Any, **named: Any) -> dict[Any, Any]:
    made: dict[Any, Any] = {}
    for each in (*values, named):
        filled_dict(evaluator.budget, made, each)
    return made


def _factorial(name: str) -> Function:
    plain = getattr(math, name)

    def run(evaluator: Evaluator, *args: Any) -> Any:
        if any(isinstance(each, int) and abs(each) > MAX_FACTORIAL for each in args):
            raise ExpressionError(
                f"math.{name} supports numbers up to {MAX_FACTORIAL}",
                values={"kind": f"math.{name}", "most": MAX_FACTORIAL},
            )
        return evaluator.budget.result(plain(*args))

    return Function(name, run)


def _prod(evaluator: Evaluator, values: Any, *, start: Any = 1) -> Any:
    total = start
    for each in snapshot(evaluator.budget, values):
        evaluator.budget.spend()
        total = multiply(evaluator.budget, total, each)
    return total


def _lcm(evaluator: Evaluator, *values: int) -> int:
    total = 1
    for each in values:
        evaluator.budget.spend()
        total = evaluator.budget.result(math.lcm(total, each))
    return total


CLASSES: dict[type, Function] = {
    **{kind: function(kind.__name__, kind) for kind in (str, float, int, bool, complex)},
    **{kind: Function(kind.__name__, _made(kind)) for kind in (list, tuple, set, frozenset)},
    dict: Function("dict", _dict),
}
"""Types that expressions name, for `isinstance`, and may call."""

BUILTINS: dict[str, Any] = {
    **{kind.__name__: kind for kind in CLASSES},
    **{each.__name__: function(each.__name__, each) for each in (
        abs, all, any, divmod, hash, ord, repr, slice,
    )},
    **{each.__name__: shallow(each.__name__, each) for each in (len, isinstance, issubclass)},
    "map": Function("map", _map), "filter": Function("filter", _filter),
    "zip": Function("zip", _zip), "enumerate": Function("enumerate", _enumerate),
    "reversed": Function("reversed", _reversed), "sorted": Function("sorted", _sorted),
    "min": _extreme("min", min), "max": _extreme("max", max), "sum": Function("sum", _sum),
    "range": Function("range", _range), "round": Function("round", _round),
    "type": Function("type", _type),
}  # fmt: skip
"""Python's functions and types, by name."""

MATH: dict[str, Any] = {
    name: function(name, value) if callable(value) else value
    for name, value in vars(math).items()
    if not name.startswith("_")
} | {
    **{name: _factorial(name) for name in ("factorial", "comb", "perm")},
    "prod": Function("prod", _prod),
    "lcm": Function("lcm", _lcm),
}
"""What is in the module math, by name."""
