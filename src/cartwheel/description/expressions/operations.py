"""Operators and methods of values, each with a bound on what it makes."""

from __future__ import annotations

import operator
import re
from collections.abc import Callable
from typing import Any

from cartwheel.description.expressions.budget import Budget, ExpressionError, bits, room

_SEQUENCES = (str, list, tuple)
_CONTAINERS = (list, tuple, dict, set, frozenset)
MAX_WIDTH = 1000
"""Of a field in ``'%…' % values``."""
_FIELD = re.compile(r"%(?:\((?P<name>[^()]*)\))?[-+ #0]*(?P<width>\*|\d*)(?:\.(?P<more>\*|\d*))?")


def add(budget: Budget, a: Any, b: Any) -> Any:
    """``a + b``."""
    if isinstance(a, _SEQUENCES) and isinstance(b, _SEQUENCES):
        budget.make(len(a) + len(b))
    return budget.result(a + b)


def multiply(budget: Budget, a: Any, b: Any) -> Any:
    """``a * b``."""
    if isinstance(a, int) and isinstance(b, int):
        bits(a.bit_length() + b.bit_length() - 1)
    for many, count in ((a, b), (b, a)):
        if isinstance(many, str) and isinstance(count, int):
            budget.text(len(many) * max(count, 0))
        elif isinstance(many, _SEQUENCES) and isinstance(count, int):
            budget.items(len(many) * max(count, 0))
    return budget.result(a * b)


def power(budget: Budget, a: Any, b: Any) -> Any:
    """``a ** b``."""
    if isinstance(a, int) and isinstance(b, int) and b > 0 and abs(a) > 1:
        bits((a.bit_length() - 1) * b)
    return budget.result(a**b)


def shift(budget: Budget, a: Any, b: Any) -> Any:
    """``a << b``."""
    if isinstance(a, int) and isinstance(b, int) and a:
        bits(a.bit_length() + max(b, 0))
    return budget.result(a << b)


def remainder(budget: Budget, a: Any, b: Any) -> Any:
    """``a % b``: of numbers, or the values of a text with fields."""
    if isinstance(a, str):
        inside = budget.weigh(b)
        fields = 0
        for field in _FIELD.finditer(a):
            fields += 1
            sizes = (field["width"] or "", field["more"] or "")
            if "*" in sizes or any(len(size) > 4 or int(size or 0) > MAX_WIDTH for size in sizes):
                raise ExpressionError(f"a field of a text is wider than {MAX_WIDTH}")
        budget.text((fields if isinstance(b, dict) else 1) * inside + fields)
    return budget.result(a % b)


def plain(function: Callable[[Any, Any], Any]) -> Callable[[Budget, Any, Any], Any]:
    """An operator whose result is no larger than its operands."""

    def run(budget: Budget, a: Any, b: Any) -> Any:
        budget.weigh(a)
        budget.weigh(b)
        return budget.result(function(a, b))

    return run


def contains(budget: Budget, a: Any, b: Any) -> bool:
    """``a in b``."""
    budget.weigh(a)
    if not isinstance(b, dict | set | frozenset):
        budget.weigh(b)
        if not isinstance(b, str | range):
            budget.spend(len(b) // 8)
    return bool(a in b)


def comparison(function: Callable[[Any, Any], Any]) -> Callable[[Budget, Any, Any], Any]:
    """A comparison; two lists are looked at whole."""

    def run(budget: Budget, a: Any, b: Any) -> Any:
        if isinstance(a, _CONTAINERS) and isinstance(b, _CONTAINERS):
            budget.weigh(a)
            budget.weigh(b)
        return function(a, b)

    return run


def hashed(budget: Budget, key: Any) -> Any:
    """A key of a dict or set."""
    if type(key) is not str:
        budget.weigh(key)
    return key


# -- methods


def _replace(budget: Budget, text: str, old: str, new: str, count: int = -1) -> str:
    found = text.count(old) if count < 0 else min(count, text.count(old))
    budget.text(len(text) + found * len(new))
    return text.replace(old, new, count)


def _join(budget: Budget, text: str, items: Any) -> str:
    parts = snapshot(budget, items)
    budget.text(budget.weigh(parts) + len(text) * len(parts))
    return text.join(parts)


def _padded(name: str) -> Callable[..., str]:
    def run(budget: Budget, text: str, width: int, *fill: str) -> str:
        budget.text(max(len(text), width))
        made: str = getattr(text, name)(width, *fill)
        return made

    return run


def _append(budget: Budget, items: list[Any], value: Any) -> None:
    room(len(items) + 1)
    budget.make(1)
    items.append(value)


def _insert(budget: Budget, items: list[Any], index: int, value: Any) -> None:
    room(len(items) + 1)
    budget.make(1)
    items.insert(index, value)


def _extend(budget: Budget, items: list[Any], values: Any) -> None:
    more = snapshot(budget, values)
    room(len(items) + len(more))
    items.extend(more)


def _update(budget: Budget, target: Any, *values: Any, **named: Any) -> None:
    for value in (*values, named):
        budget.weigh(value)
        budget.items(len(target) + len(value))
    target.update(*values, **named)


def snapshot(budget: Budget, values: Any) -> list[Any]:
    """What an expression iterates over, as a list."""
    if not isinstance(values, (*_CONTAINERS, str, range)):
        raise TypeError(f"'{type(values).__name__}' object is not iterable")
    budget.items(len(values))
    return list(values)


def _listed(name: str) -> Callable[..., list[Any]]:
    def run(budget: Budget, mapping: dict[Any, Any]) -> list[Any]:
        budget.items(len(mapping))
        return list(getattr(mapping, name)())

    return run


def _safe(name: str) -> Callable[..., Any]:
    def run(budget: Budget, value: Any, *args: Any, **named: Any) -> Any:
        for each in (*args, *named.values()):
            budget.weigh(each)
        return getattr(value, name)(*args, **named)

    return run


def _searched(name: str) -> Callable[..., Any]:
    """A method that compares all that is in a list."""
    safe = _safe(name)

    def run(budget: Budget, value: Any, *args: Any) -> Any:
        budget.weigh(value)
        return safe(budget, value, *args)

    return run


_TEXT = (
    "split rsplit splitlines strip lstrip rstrip upper lower title capitalize swapcase casefold "
    "startswith endswith find rfind index rindex count partition rpartition removeprefix "
    "removesuffix isdigit isalpha isalnum isnumeric isdecimal isspace isupper islower "
    "isidentifier istitle isascii"
)
_SET = (
    "add discard remove pop copy clear union intersection difference symmetric_difference "
    "issubset issuperset isdisjoint"
)
METHODS: dict[type, dict[str, Callable[..., Any]]] = {
    str: {name: _safe(name) for name in _TEXT.split()}
    | {name: _padded(name) for name in ("ljust", "rjust", "center", "zfill")}
    | {"replace": _replace, "join": _join},
    list: {name: _safe(name) for name in ("pop", "reverse", "copy", "clear")}
    | {name: _searched(name) for name in ("index", "count", "remove")}
    | {"append": _append, "insert": _insert, "extend": _extend},
    tuple: {name: _searched(name) for name in ("index", "count")},
    dict: {name: _safe(name) for name in ("get", "pop", "popitem", "copy", "clear")}
    | {name: _listed(name) for name in ("keys", "values", "items")}
    | {"setdefault": _safe("setdefault"), "update": _update},
    set: {name: _safe(name) for name in _SET.split()} | {"update": _update},
    frozenset: {name: _safe(name) for name in _SET.split()[4:]},
    int: {"bit_length": _safe("bit_length"), "conjugate": _safe("conjugate")},
    float: {"is_integer": _safe("is_integer"), "conjugate": _safe("conjugate")},
    complex: {"conjugate": _safe("conjugate")},
    range: {"index": _safe("index"), "count": _safe("count")},
}
"""What can be called on a value, by its type. Never ``format``, which reaches attributes."""


def methods_of(value: Any) -> dict[str, Callable[..., Any]]:
    """The methods of a value, by name."""
    for kind in type(value).__mro__:
        if kind in METHODS:
            return METHODS[kind]
    return {}


BINARY: dict[str, Callable[[Budget, Any, Any], Any]] = {
    "Add": add,
    "Mult": multiply,
    "Pow": power,
    "LShift": shift,
    "Mod": remainder,
    "Sub": plain(operator.sub),
    "Div": plain(operator.truediv),
    "FloorDiv": plain(operator.floordiv),
    "RShift": plain(operator.rshift),
    "BitOr": plain(operator.or_),
    "BitAnd": plain(operator.and_),
    "BitXor": plain(operator.xor),
}
FLOATS: dict[str, Callable[[Any, Any], Any]] = {
    "Add": operator.add,
    "Sub": operator.sub,
    "Mult": operator.mul,
    "Div": operator.truediv,
}
"""Operators of numbers that need no bound."""
COMPARISONS: dict[str, Callable[[Budget, Any, Any], Any]] = {
    "Eq": comparison(operator.eq),
    "NotEq": comparison(operator.ne),
    "Lt": comparison(operator.lt),
    "LtE": comparison(operator.le),
    "Gt": comparison(operator.gt),
    "GtE": comparison(operator.ge),
    "In": contains,
    "NotIn": lambda budget, a, b: not contains(budget, a, b),
    "Is": lambda _, a, b: a is b,
    "IsNot": lambda _, a, b: a is not b,
}
UNARY: dict[str, Callable[[Any], Any]] = {
    "Not": operator.not_,
    "USub": operator.neg,
    "UAdd": operator.pos,
    "Invert": operator.invert,
}
