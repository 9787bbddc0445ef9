"""Compiles an expression to closures, one for each node of its syntax tree.

The file is long because it has one function for each kind of node, which call each other.
"""

from __future__ import annotations

import ast
import threading
import warnings
from collections.abc import Callable
from functools import lru_cache
from typing import Any, cast

from cartwheel.description.expressions.budget import ExpressionError, bits, room
from cartwheel.description.expressions.operations import (
    BINARY,
    COMPARISONS,
    FLOATS,
    UNARY,
    filled_dict,
    filled_set,
    hashed,
    snapshot,
)
from cartwheel.description.expressions.scope import Lambda, Scope, entry, not_allowed

MAX_LENGTH = 5000
"""Maximum length of an expression. The longest in public robots has some 300 characters."""
_KEPT_LENGTH = 300
"""Maximum length of an expression whose closure is cached; the closure of the longest takes 1 MB.
"""
MAX_NESTING = 100

_lock = threading.Lock()


_Code = Callable[[Scope], Any]


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
    return _code(_parsed(text), 0)


def _parsed(text: str) -> ast.expr:
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
    return cast("ast.Expression", tree).body


def free_names(text: str) -> list[str]:
    """The names that an expression uses, and does not define itself, in their order.

    Raises:
        ExpressionError: The expression is not allowed.
        SyntaxError: The text is not an expression.
    """
    nodes = list(ast.walk(_parsed(text)))
    names = [each for each in nodes if isinstance(each, ast.Name)]
    bound = {each.id for each in names if isinstance(each.ctx, ast.Store)}
    bound |= {each.arg for each in nodes if isinstance(each, ast.arg)}
    return [each.id for each in names if each.id not in bound]


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

    def run(scope: Scope) -> Any:
        if scope.local and name in scope.local:
            return scope.local[name]
        return entry(scope.names, name)

    return run


def _attribute(node: ast.Attribute, depth: int) -> _Code:
    inner, name = _code(node.value, depth), node.attr
    if name.startswith("_"):
        raise not_allowed(f'"{name}"')
    return lambda scope: scope.evaluator.attribute(inner(scope), name)


def _subscript(node: ast.Subscript, depth: int) -> _Code:
    inner, key = _code(node.value, depth), _code(node.slice, depth)

    def run(scope: Scope) -> Any:
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

    def run(scope: Scope) -> Any:
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

    def run(scope: Scope) -> Any:
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

    def run(scope: Scope) -> Any:
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


def _items(nodes: list[ast.expr], depth: int) -> Callable[[Scope], list[Any]]:
    codes = [
        (_code(each.value, depth), True)
        if isinstance(each, ast.Starred)
        else (_code(each, depth), False)
        for each in nodes
    ]

    def run(scope: Scope) -> list[Any]:
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

    def run(scope: Scope) -> Any:
        return {hashed(scope.evaluator.budget, each) for each in items(scope)}

    return run


def _dict(node: ast.Dict, depth: int) -> _Code:
    pairs = [
        (_code(key, depth) if key is not None else None, _code(value, depth))
        for key, value in zip(node.keys, node.values, strict=True)
    ]

    def run(scope: Scope) -> Any:
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

    def words(scope: Scope) -> dict[str, Any]:
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

    def make(scope: Scope) -> Any:
        standard = dict(
            zip(names[len(names) - len(defaults) :], [d(scope) for d in defaults], strict=True)
        )

        def run(args: list[Any], named: dict[str, Any]) -> Any:
            inner = scope.inner()
            inner.local.update(standard | dict(zip(names, args, strict=False)) | named)
            if len(args) > len(names) or not set(names) <= set(inner.local):
                raise TypeError(f"the lambda expects {len(names)} arguments")
            return body(inner)

        return Lambda(run)

    return make


def _loop(
    loops: list[ast.comprehension], depth: int, visit: Callable[[Scope, list[Any]], None]
) -> Callable[[Scope], list[Any]]:
    """Runs `visit` in each iteration of nested loops; it appends to the returned list."""
    for loop in loops:
        if loop.is_async:
            raise not_allowed("async")
    parts = [
        (_target(each.target), _code(each.iter, depth), [_code(test, depth) for test in each.ifs])
        for each in loops
    ]

    def rounds(scope: Scope, level: int, made: list[Any]) -> None:
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

    def run(scope: Scope) -> list[Any]:
        made: list[Any] = []
        rounds(scope.inner(), 0, made)
        scope.evaluator.budget.items(len(made))
        return made

    return run


def _target(node: ast.expr) -> Callable[[Scope, Any], None]:
    if isinstance(node, ast.Name):
        name = node.id

        def assign(scope: Scope, value: Any) -> None:
            scope.local[name] = value

        return assign
    if isinstance(node, ast.Tuple | ast.List):
        targets = [_target(each) for each in node.elts]

        def spread(scope: Scope, value: Any) -> None:
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

    def visit(scope: Scope, made: list[Any]) -> None:
        made.append(hashed(scope.evaluator.budget, element(scope)))

    loop = _loop(node.generators, depth, visit)
    return lambda scope: filled_set(scope.evaluator.budget, loop(scope))


def _dict_comprehension(node: ast.DictComp, depth: int) -> _Code:
    key, value = _code(node.key, depth), _code(node.value, depth)

    def visit(scope: Scope, made: list[Any]) -> None:
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
