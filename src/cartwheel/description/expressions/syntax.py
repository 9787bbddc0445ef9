"""Compiles an expression to closures, one for each node of its syntax tree."""

from __future__ import annotations

import ast
import threading
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, cast

from cartwheel.description.expressions.budget import Budget, ExpressionError, bits, room
from cartwheel.description.expressions.functions import CLASSES, Function, sort
from cartwheel.description.expressions.operations import (
    BINARY,
    COMPARISONS,
    FLOATS,
    UNARY,
    filled_dict,
    filled_set,
    hashed,
    methods_of,
    snapshot,
)

MAX_LENGTH = 5000
"""Maximum length of an expression. The longest in public robots has some 300 characters."""
_KEPT_LENGTH = 300
"""Maximum length of an expression whose closure is cached; the closure of the longest takes 1 MB.
"""
MAX_NESTING = 100
MAX_CALLS = 30
"""Maximum depth of nested lambda calls."""

_lock = threading.Lock()


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
        value = compiled(text.strip())(_Scope(self, names, {}))
        if type(value) not in (float, int, bool, str):
            self.budget.weigh(value)
        return value

    def call(self, called: Any, args: list[Any], named: dict[str, Any]) -> Any:
        """Calls an allowed function."""
        self.budget.spend()
        found = CLASSES.get(called) if isinstance(called, type) else called
        if isinstance(found, Function):
            return found.run(self, *args, **named)
        if isinstance(found, _Lambda):
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
            return _entry(value, name)
        if isinstance(value, self.dotted) and not hasattr(dict, name):
            return getattr(value, name)
        if isinstance(value, int | float | complex) and name in ("real", "imag"):
            return getattr(value, name)
        raise not_allowed(
            f'"{type(value).__name__}.{name}"',
            hint=f"Call it: .{name}(…)." if name in methods_of(value) else None,
        )


def not_allowed(part: str, *, hint: str | None = None) -> ExpressionError:
    """The error for a part that is not allowed; the value omits the quotes in the message."""
    return ExpressionError(
        f"{part} is not allowed in an expression", hint=hint, values={"refused": part.strip('"')}
    )


@dataclass(slots=True)
class _Scope:
    evaluator: Evaluator
    names: Mapping[str, Any]
    local: dict[str, Any]
    """Names in comprehensions and lambdas."""

    def inner(self) -> _Scope:
        return _Scope(self.evaluator, self.names, dict(self.local))


_Code = Callable[[_Scope], Any]


@dataclass(frozen=True, slots=True, eq=False)
class _Lambda:
    run: Callable[[list[Any], dict[str, Any]], Any]


def compiled(text: str) -> _Code:
    """The closure of an expression.

    Raises:
        ExpressionError: The expression is not allowed.
        SyntaxError: The text is not an expression.
    """
    return _kept(text) if len(text) <= _KEPT_LENGTH else _compiled(text)


@lru_cache(maxsize=4096)
def _kept(text: str) -> _Code:
    return _compiled(text)


def _compiled(text: str) -> _Code:
    if len(text) > MAX_LENGTH:
        raise ExpressionError(
            f"the expression is longer than {MAX_LENGTH} characters",
            values={"kind": "expression", "most": MAX_LENGTH},
        )
    try:
        # Python prints warnings about unusual syntax. The warning filters are shared by the
        # process.
        with _lock, warnings.catch_warnings():
            warnings.simplefilter("ignore")
            tree = compile(text, "<expression>", "eval", ast.PyCF_ONLY_AST, dont_inherit=True)
    except (MemoryError, RecursionError):
        raise ExpressionError(
            "the expression is nested too deeply", values={"kind": "nesting"}
        ) from None
    return _code(cast("ast.Expression", tree).body, 0)


def _code(node: ast.expr, depth: int) -> _Code:
    if depth > MAX_NESTING:
        raise ExpressionError(
            f"the expression is nested more than {MAX_NESTING} levels deep",
            values={"kind": "nesting", "most": MAX_NESTING},
        )
    make = _NODES.get(type(node))
    if make is None:
        what = _WORDS.get(type(node).__name__, type(node).__name__)
        raise not_allowed(what)
    return make(node, depth + 1)


_WORDS = {
    "NamedExpr": "the operator :=", "JoinedStr": "an f-string", "Await": "await",
    "Yield": "yield", "YieldFrom": "yield", "Starred": "a starred expression",
}  # fmt: skip


def _constant(node: ast.Constant, _: int) -> _Code:
    value = node.value
    if value is not None and not isinstance(value, str | int | float | complex):
        raise not_allowed(repr(value))
    if isinstance(value, int) and not isinstance(value, bool):
        bits(value.bit_length())
    return lambda _: value


def _name(node: ast.Name, _: int) -> _Code:
    name = node.id
    if name.startswith("__"):
        raise not_allowed(f'"{name}"')

    def run(scope: _Scope) -> Any:
        if scope.local and name in scope.local:
            return scope.local[name]
        return _entry(scope.names, name)

    return run


def _entry(names: Any, name: str) -> Any:
    try:
        return names[name]
    except KeyError:
        raise NameError(f"name '{name}' is not defined", name=name) from None


def _attribute(node: ast.Attribute, depth: int) -> _Code:
    inner, name = _code(node.value, depth), node.attr
    if name.startswith("_"):
        raise not_allowed(f'"{name}"')
    return lambda scope: scope.evaluator.attribute(inner(scope), name)


def _subscript(node: ast.Subscript, depth: int) -> _Code:
    inner, key = _code(node.value, depth), _code(node.slice, depth)

    def run(scope: _Scope) -> Any:
        value, index = inner(scope), key(scope)
        evaluator = scope.evaluator
        evaluator.budget.spend()
        if isinstance(value, evaluator.namespace):
            return evaluator.attribute(value, str(index))
        if not isinstance(value, str | list | tuple | dict | range):
            raise TypeError(f"'{type(value).__name__}' object is not subscriptable")
        found = value[hashed(evaluator.budget, index)]
        return evaluator.budget.result(found) if isinstance(index, slice) else found

    return run


def _slice(node: ast.Slice, depth: int) -> _Code:
    parts = [_code(each, depth) if each else None for each in (node.lower, node.upper, node.step)]
    return lambda scope: slice(*(each(scope) if each else None for each in parts))


def _binary(node: ast.BinOp, depth: int) -> _Code:
    operation = BINARY.get(type(node.op).__name__)
    if operation is None:
        raise not_allowed("the operator @")
    left, right = _code(node.left, depth), _code(node.right, depth)
    plain = FLOATS.get(type(node.op).__name__)

    def run(scope: _Scope) -> Any:
        budget = scope.evaluator.budget
        budget.spend()
        a, b = left(scope), right(scope)
        if plain is not None and type(a) is float and (type(b) is float or type(b) is int):
            return plain(a, b)
        return operation(budget, a, b)

    return run


def _unary(node: ast.UnaryOp, depth: int) -> _Code:
    operation, inner = UNARY[type(node.op).__name__], _code(node.operand, depth)
    return lambda scope: scope.evaluator.budget.result(operation(inner(scope)))


def _bool(node: ast.BoolOp, depth: int) -> _Code:
    codes = [_code(each, depth) for each in node.values]
    stop = isinstance(node.op, ast.Or)

    def run(scope: _Scope) -> Any:
        value: Any = None
        for code in codes:
            value = code(scope)
            if bool(value) is stop:
                break
        return value

    return run


def _compare(node: ast.Compare, depth: int) -> _Code:
    first = _code(node.left, depth)
    rest = [
        (COMPARISONS[type(op).__name__], _code(each, depth))
        for op, each in zip(node.ops, node.comparators, strict=True)
    ]

    def run(scope: _Scope) -> Any:
        left, result = first(scope), True
        budget = scope.evaluator.budget
        for operation, code in rest:
            budget.spend()
            right = code(scope)
            result = operation(budget, left, right)
            if not result:
                break
            left = right
        return result

    return run


def _choice(node: ast.IfExp, depth: int) -> _Code:
    test, yes, no = (_code(each, depth) for each in (node.test, node.body, node.orelse))
    return lambda scope: yes(scope) if test(scope) else no(scope)


def _items(nodes: list[ast.expr], depth: int) -> Callable[[_Scope], list[Any]]:
    codes = [
        (_code(each.value, depth), True)
        if isinstance(each, ast.Starred)
        else (_code(each, depth), False)
        for each in nodes
    ]

    def run(scope: _Scope) -> list[Any]:
        made: list[Any] = []
        for code, starred in codes:
            if starred:
                made += snapshot(scope.evaluator.budget, code(scope))
            else:
                made.append(code(scope))
        scope.evaluator.budget.items(len(made))
        return made

    return run


def _list(node: ast.List, depth: int) -> _Code:
    return _items(node.elts, depth)


def _tuple(node: ast.Tuple, depth: int) -> _Code:
    items = _items(node.elts, depth)
    return lambda scope: tuple(items(scope))


def _set(node: ast.Set, depth: int) -> _Code:
    items = _items(node.elts, depth)

    def run(scope: _Scope) -> Any:
        return {hashed(scope.evaluator.budget, each) for each in items(scope)}

    return run


def _dict(node: ast.Dict, depth: int) -> _Code:
    pairs = [
        (_code(key, depth) if key is not None else None, _code(value, depth))
        for key, value in zip(node.keys, node.values, strict=True)
    ]

    def run(scope: _Scope) -> Any:
        budget = scope.evaluator.budget
        made: dict[Any, Any] = {}
        for key, code in pairs:
            if key is None:
                filled_dict(budget, made, _mapping(code(scope)))
            else:
                made[hashed(budget, key(scope))] = code(scope)
        return budget.result(made)

    return run


def _mapping(value: Any) -> dict[Any, Any]:
    if not isinstance(value, dict):
        raise TypeError(f"'{type(value).__name__}' object is not a mapping")
    return dict(value)


def _call(node: ast.Call, depth: int) -> _Code:
    items = _items(node.args, depth)
    named = [(each.arg, _code(each.value, depth)) for each in node.keywords]

    def words(scope: _Scope) -> dict[str, Any]:
        made: dict[str, Any] = {}
        for name, code in named:
            made.update(_mapping(code(scope)) if name is None else {name: code(scope)})
        return made

    if isinstance(node.func, ast.Attribute):
        inner, method = _code(node.func.value, depth), node.func.attr
        if method.startswith("_"):
            raise not_allowed(f'"{method}"')
        return lambda scope: scope.evaluator.method(
            inner(scope), method, items(scope), words(scope)
        )
    called = _code(node.func, depth)
    return lambda scope: scope.evaluator.call(called(scope), items(scope), words(scope))


def _lambda(node: ast.Lambda, depth: int) -> _Code:
    given = node.args
    if given.vararg or given.kwarg or given.kwonlyargs:
        raise not_allowed("a lambda's *")
    names = [each.arg for each in (*given.posonlyargs, *given.args)]
    defaults = [_code(each, depth) for each in given.defaults]
    body = _code(node.body, depth)

    def make(scope: _Scope) -> Any:
        standard = dict(
            zip(names[len(names) - len(defaults) :], [d(scope) for d in defaults], strict=True)
        )

        def run(args: list[Any], named: dict[str, Any]) -> Any:
            inner = scope.inner()
            inner.local.update(standard | dict(zip(names, args, strict=False)) | named)
            if len(args) > len(names) or not set(names) <= set(inner.local):
                raise TypeError(f"the lambda expects {len(names)} arguments")
            return body(inner)

        return _Lambda(run)

    return make


def _loop(
    loops: list[ast.comprehension], depth: int, visit: Callable[[_Scope, list[Any]], None]
) -> Callable[[_Scope], list[Any]]:
    """Runs `visit` in each iteration of nested loops; it appends to the returned list."""
    for loop in loops:
        if loop.is_async:
            raise not_allowed("async")
    parts = [
        (_target(each.target), _code(each.iter, depth), [_code(test, depth) for test in each.ifs])
        for each in loops
    ]

    def rounds(scope: _Scope, level: int, made: list[Any]) -> None:
        if level == len(parts):
            visit(scope, made)
            room(len(made))
            return
        target, values, tests = parts[level]
        for value in snapshot(scope.evaluator.budget, values(scope)):
            scope.evaluator.budget.spend()
            target(scope, value)
            if all(test(scope) for test in tests):
                rounds(scope, level + 1, made)

    def run(scope: _Scope) -> list[Any]:
        made: list[Any] = []
        rounds(scope.inner(), 0, made)
        scope.evaluator.budget.items(len(made))
        return made

    return run


def _target(node: ast.expr) -> Callable[[_Scope, Any], None]:
    if isinstance(node, ast.Name):
        name = node.id

        def assign(scope: _Scope, value: Any) -> None:
            scope.local[name] = value

        return assign
    if isinstance(node, ast.Tuple | ast.List):
        targets = [_target(each) for each in node.elts]

        def spread(scope: _Scope, value: Any) -> None:
            parts = snapshot(scope.evaluator.budget, value)
            if len(parts) != len(targets):
                raise ValueError(f"{len(parts)} values cannot be assigned to {len(targets)} names")
            for target, part in zip(targets, parts, strict=True):
                target(scope, part)

        return spread
    raise ExpressionError(
        "the target of an assignment in an expression must be a variable name",
        values={"refused": "assignment"},
    )


def _comprehension(node: ast.ListComp | ast.GeneratorExp, depth: int) -> _Code:
    element = _code(node.elt, depth)
    return _loop(node.generators, depth, lambda scope, made: made.append(element(scope)))


def _set_comprehension(node: ast.SetComp, depth: int) -> _Code:
    element = _code(node.elt, depth)

    def visit(scope: _Scope, made: list[Any]) -> None:
        made.append(hashed(scope.evaluator.budget, element(scope)))

    loop = _loop(node.generators, depth, visit)
    return lambda scope: filled_set(scope.evaluator.budget, loop(scope))


def _dict_comprehension(node: ast.DictComp, depth: int) -> _Code:
    key, value = _code(node.key, depth), _code(node.value, depth)

    def visit(scope: _Scope, made: list[Any]) -> None:
        made.append((hashed(scope.evaluator.budget, key(scope)), value(scope)))

    loop = _loop(node.generators, depth, visit)
    return lambda scope: filled_dict(scope.evaluator.budget, {}, loop(scope))


_NODES: dict[type[ast.expr], Callable[[Any, int], _Code]] = {
    ast.Constant: _constant,
    ast.Name: _name,
    ast.Attribute: _attribute,
    ast.Subscript: _subscript,
    ast.Slice: _slice,
    ast.BinOp: _binary,
    ast.UnaryOp: _unary,
    ast.BoolOp: _bool,
    ast.Compare: _compare,
    ast.IfExp: _choice,
    ast.List: _list,
    ast.Tuple: _tuple,
    ast.Set: _set,
    ast.Dict: _dict,
    ast.Call: _call,
    ast.Lambda: _lambda,
    ast.ListComp: _comprehension,
    ast.GeneratorExp: _comprehension,
    ast.SetComp: _set_comprehension,
    ast.DictComp: _dict_comprehension,
}
"""All syntax that an expression may contain."""
