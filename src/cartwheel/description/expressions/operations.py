"""Operators and methods of values; the size of each result is limited."""

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
_NESTED_KEY = re.compile(r"%\([^()]*\(")
"""A key with a parenthesis in it, behind which `_FIELD` would not see the width."""
_COMPARED = 1000
"""Characters that are compared in the time of one operation."""
_HASHED = 200
"""Keys that are put into a set between two looks at the clock: where all of them have the same
hash, the time grows with their square."""


def add(budget: Budget, a: Any, b: Any) -> Any:
    """``a + b``."""
    if isinstance(a, str) and isinstance(b, str):
        budget.text(len(a) + len(b))
        return a + b
    if isinstance(a, _SEQUENCES) and isinstance(b, _SEQUENCES):
        room(len(a) + len(b))
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
        if _NESTED_KEY.search(a):
            raise ExpressionError(
                "the key of a format field contains a parenthesis", values={"refused": "("}
            )
        inside = budget.weigh(b)
        fields = width = 0
        for field in _FIELD.finditer(a):
            fields += 1
            sizes = (field["width"] or "", field["more"] or "")
            if "*" in sizes or any(len(size) > 4 or int(size or 0) > MAX_WIDTH for size in sizes):
                raise ExpressionError(
                    f"a format field is wider than {MAX_WIDTH} characters",
                    values={"kind": "field", "most": MAX_WIDTH},
                )
            width += sum(int(size or 0) for size in sizes)
        budget.text((fields if isinstance(b, dict) else 1) * inside + fields + width)
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
    budget.grow(len(items), 1)
    items.append(value)


def _insert(budget: Budget, items: list[Any], index: int, value: Any) -> None:
    budget.grow(len(items), 1)
    items.insert(index, value)


def _extend(budget: Budget, items: list[Any], values: Any) -> None:
    more = snapshot(budget, values)
    room(len(items) + len(more))
    items.extend(more)


def _update(budget: Budget, target: dict[Any, Any], *values: Any, **named: Any) -> None:
    for value in (*values, named):
        filled_dict(budget, target, value)


def _setdefault(budget: Budget, target: dict[Any, Any], key: Any, *value: Any) -> Any:
    budget.grow(len(target), 1)
    return target.setdefault(hashed(budget, key), *value)


def filled_dict(budget: Budget, target: dict[Any, Any], values: Any) -> dict[Any, Any]:
    """A dict, with the entries of another or of pairs put into it."""
    pairs = list(dict.items(values)) if isinstance(values, dict) else snapshot(budget, values)
    budget.grow(len(target), len(pairs))
    budget.weigh(pairs)
    for start in range(0, len(pairs), _HASHED):
        budget.look()
        target.update(pairs[start : start + _HASHED])
    return target


def filled_set(budget: Budget, values: Any, target: set[Any] | None = None) -> set[Any]:
    """A set, with what is in another value put into it."""
    made: set[Any] = set() if target is None else target
    items = snapshot(budget, values)
    budget.grow(len(made), len(items))
    budget.weigh(items)
    for start in range(0, len(items), _HASHED):
        budget.look()
        made.update(items[start : start + _HASHED])
    return made


def _set_add(budget: Budget, target: set[Any], value: Any) -> None:
    budget.grow(len(target), 1)
    target.add(hashed(budget, value))


def _set_update(budget: Budget, target: set[Any], *values: Any) -> None:
    for value in values:
        filled_set(budget, value, target)


def _of_sets(name: str) -> Callable[..., Any]:
    """A method that makes sets of its arguments."""

    def run(budget: Budget, value: Any, *args: Any) -> Any:
        budget.weigh(value)
        result = value.copy()
        for each in args:
            other = each if isinstance(each, set | frozenset) else filled_set(budget, each)
            budget.weigh(other)
            result = budget.result(getattr(result, name)(other))
        return result

    return run


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


def _slow(name: str) -> Callable[..., Any]:
    """A method that may compare each character of a text with each of another."""
    safe = _safe(name)

    def run(budget: Budget, text: str, *args: Any, **named: Any) -> Any:
        for each in (*args, *named.values()):
            if isinstance(each, str):
                budget.spend(len(text) * len(each) // _COMPARED)
        return safe(budget, text, *args, **named)

    return run


_TEXT = (
    "split splitlines upper lower title capitalize swapcase casefold "
    "startswith endswith find index count partition removeprefix "
    "removesuffix isdigit isalpha isalnum isnumeric isdecimal isspace isupper islower "
    "isidentifier istitle isascii"
)
_SLOW = "strip lstrip rstrip rsplit rfind rindex rpartition"
"""Python searches from the right, and among the characters to strip, one by one."""
_OF_SETS = "union intersection difference symmetric_difference issubset issuperset isdisjoint"
METHODS: dict[type, dict[str, Callable[..., Any]]] = {
    str: {name: _safe(name) for name in _TEXT.split()}
    | {name: _slow(name) for name in _SLOW.split()}
    | {name: _padded(name) for name in ("ljust", "rjust", "center", "zfill")}
    | {"replace": _replace, "join": _join},
    list: {name: _safe(name) for name in ("pop", "reverse", "copy", "clear")}
    | {name: _searched(name) for name in ("index", "count", "remove")}
    | {"append": _append, "insert": _insert, "extend": _extend},
    tuple: {name: _searched(name) for name in ("index", "count")},
    dict: {name: _safe(name) for name in ("get", "pop", "popitem", "copy", "clear")}
    | {name: _listed(name) for name in ("keys", "values", "items")}
    | {"setdefault": _setdefault, "update": _update},
    set: {name: _safe(name) for name in ("discard", "remove", "pop", "copy", "clear")}
    | {name: _of_sets(name) for name in _OF_SETS.split()}
    | {"add": _set_add, "update": _set_update},
    frozenset: {name: _of_sets(name) for name in ("copy", *_OF_SETS.split())},
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
"""Their results are counted by the caller."""
