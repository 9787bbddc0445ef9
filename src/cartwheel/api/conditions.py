"""Conditions of `World.run_until`, and their text and values for error messages."""

from __future__ import annotations

import ast
import inspect
import textwrap
from collections.abc import Callable, Iterator, Mapping
from types import FunctionType
from typing import Any

from cartwheel.codes.world import CONDITION_INVALID
from cartwheel.errors import CartwheelError

_LONGEST = 200
"""Maximum length of a text in an error message."""


class Condition:
    """A function that is called until it returns a true value.

    Args:
        function: Takes no arguments, or the world.
        world: The world.

    Raises:
        CartwheelError: `function` cannot be called with no arguments or one.
    """

    def __init__(self, function: Callable[..., Any], world: object) -> None:
        self._function = function
        self._arguments = (world,) * _arity(function)

    def holds(self) -> bool:
        """Calls the function. Its errors are raised.

        Raises:
            CartwheelError: The result is neither true nor false, as an array is not.
        """
        found = self._function(*self._arguments)
        try:
            return bool(found)
        except ValueError as error:
            raise CartwheelError(
                f"the condition must return true or false ({error})",
                code=CONDITION_INVALID,
                hint="Use .all() or .any() for an array.",
                values={"condition": self.text},
            ) from None

    @property
    def text(self) -> str:
        """The source of a lambda, or the name of a function."""
        body = _body(self._function)
        if body is not None:
            return _shortened(ast.unparse(body))
        name = getattr(self._function, "__qualname__", None) or repr(self._function)
        return _shortened(name.rpartition("<locals>.")[2])

    def values(self) -> dict[str, str]:
        """The current values of both sides of each comparison in a lambda, by their source."""
        body = _body(self._function)
        if body is None or not isinstance(self._function, FunctionType):
            return {}
        names = {**self._function.__globals__, **_closure(self._function)}
        parameters = inspect.signature(self._function).parameters
        names.update(zip(parameters, self._arguments, strict=False))
        return dict(_evaluated(body, names))


def _arity(function: Callable[..., Any]) -> int:
    """How many arguments the function takes: none, or one without a default."""
    if not callable(function):
        raise _refused(function)
    try:
        signature = inspect.signature(function)
    except (TypeError, ValueError):
        return 0  # a function of an extension module
    for count in (0, 1):
        try:
            signature.bind(*(None,) * count)
        except TypeError:
            continue
        return count
    raise _refused(function)


def _refused(function: object) -> CartwheelError:
    return CartwheelError(
        "the condition must be a function without arguments, or with the world as its argument",
        code=CONDITION_INVALID,
        hint="Pass a function, such as lambda: world.time > 2.",
        values={"condition": _shortened(repr(function))},
    )


def _body(function: Callable[..., Any]) -> ast.expr | None:
    """The expression of a lambda; None if there is none, or if its line contains several."""
    if getattr(function, "__name__", "") != "<lambda>":
        return None
    try:
        source = textwrap.dedent(inspect.getsource(function)).strip()
    except (OSError, TypeError):
        return None
    for text in (source, f"{source}\n    pass", source.rstrip(",)"), f"f({source}"):
        try:
            tree = ast.parse(text)
        except (SyntaxError, ValueError):
            continue
        lambdas = [node for node in ast.walk(tree) if isinstance(node, ast.Lambda)]
        if len(lambdas) == 1:
            return lambdas[0].body
    return None


def _closure(function: FunctionType) -> dict[str, Any]:
    cells = zip(function.__code__.co_freevars, function.__closure__ or (), strict=True)
    found = {}
    for name, cell in cells:
        try:
            found[name] = cell.cell_contents
        except ValueError:
            continue  # a variable that is not assigned yet
    return found


def _evaluated(body: ast.expr, names: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    for node in ast.walk(body):
        if not isinstance(node, ast.Compare):
            continue
        for side in (node.left, *node.comparators):
            if isinstance(side, ast.Constant):
                continue
            try:
                # The user's own code, which ran at every step.
                value = eval(  # noqa: S307
                    compile(ast.Expression(side), "<condition>", "eval"), dict(names)
                )
                yield _shortened(ast.unparse(side)), _shortened(repr(value))
            except Exception:  # noqa: BLE001, S112 - it only decorates an error message
                continue


def _shortened(text: str) -> str:
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}…"
