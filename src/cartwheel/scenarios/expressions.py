"""Expressions in scenarios: ``${speed * 2}`` in values, and conditions.

A scenario may come from an untrusted source, so its expressions are evaluated like those of xacro
files: without access to Python, and with limits.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from typing import Any

from cartwheel.codes.command import SCENARIO_EXPRESSION
from cartwheel.description.expressions import BUILTINS, MATH, Budget, Evaluator, Function
from cartwheel.description.expressions.syntax import compiled, free_names
from cartwheel.errors import CartwheelError, Pickled
from cartwheel.scenarios.document import Document, Key
from cartwheel.similar_names import suggestion

_SECONDS = 0.5
"""Maximum CPU time of an expression, s."""
_WHOLE = re.compile(r"\$\{([^{}]*)\}")
_NAMES: dict[str, Any] = {**BUILTINS, **MATH}
CONDITION_NAMES = frozenset(
    {
        *("clearance", "count", "distance", "field", "joint", "peak_force"),
        *("pitch", "roll", "tilt", "time", "x", "y", "yaw", "z"),
    }
)
"""What the expression of a condition can use in addition to Python's and math's functions."""
NAME_HINT = "Write parameters of the scenario as ${name}."


class _NoTable:
    """xacro's tables of names do not exist here."""


class ExpressionFaultError(Pickled, Exception):
    """An expression that cannot be evaluated.

    Args:
        reason: Why, as part of a sentence.
        hint: What to write instead.
    """

    def __init__(self, reason: str, hint: str = "") -> None:
        super().__init__(reason)
        self.reason, self.hint = reason, hint


def evaluate(text: str, names: Mapping[str, Any]) -> Any:
    """The value of an expression.

    Args:
        text: The expression, in Python's syntax.
        names: Values and `function` results by name, in addition to Python's and math's functions.

    Raises:
        ExpressionFaultError: The expression is invalid, or its evaluation fails.
        CartwheelError: One of the functions failed.
    """
    evaluator = Evaluator(Budget(_SECONDS), namespace=_NoTable, dotted=_NoTable)
    try:
        return evaluator.evaluate(text, {**_NAMES, **names})
    except NameError as error:
        name = str(error.name)
        raise ExpressionFaultError(f'"{name}" is not defined', suggestion(name, names)) from None
    except SyntaxError as error:
        raise ExpressionFaultError(f"{error.msg}") from None
    except (CartwheelError, ExpressionFaultError):
        raise
    except Exception as error:  # noqa: BLE001 - whatever an untrusted operation raises
        raise ExpressionFaultError(f"{type(error).__name__}: {error}") from None


def function(name: str, plain: Callable[..., Any]) -> Function:
    """A function for `evaluate`."""
    return Function(name, lambda _, *args, **named: plain(*args, **named))


def substituted(document: Document, value: Any, names: Mapping[str, Any], key: Key = ()) -> Any:
    """A value with its ``${…}`` replaced.

    A text that consists of one expression becomes the value of the expression. Otherwise, the
    values become parts of the text.

    Raises:
        ScenarioError: An expression cannot be evaluated.
    """
    if isinstance(value, dict):
        return {
            name: substituted(document, each, names, (*key, name)) for name, each in value.items()
        }
    if isinstance(value, list):
        return [
            substituted(document, each, names, (*key, index)) for index, each in enumerate(value)
        ]
    if not isinstance(value, str) or "${" not in value:
        return value

    def value_of(text: str) -> Any:
        try:
            return evaluate(text, names)
        except ExpressionFaultError as error:
            reason, hint = error.reason, error.hint
        except CartwheelError as error:
            reason, hint = error.message, error.hint or ""
        raise _failure(document, key, f"${{{text}}} cannot be evaluated: {reason}", text, hint)

    whole = _WHOLE.fullmatch(value)
    if whole:
        return value_of(whole[1])
    return _WHOLE.sub(lambda found: str(value_of(found[1])), value)


def check_conditions(document: Document, value: Any, key: Key) -> None:
    """Checks the syntax and names of all conditions with the key ``expression`` in a part of a
    scenario.

    Raises:
        ScenarioError: An expression is not one, or uses a name that does not exist.
    """
    if isinstance(value, list):
        for index, each in enumerate(value):
            check_conditions(document, each, (*key, index))
    elif isinstance(value, dict):
        for name, each in value.items():
            if name == "expression" and isinstance(each, str):
                _check_syntax(document, each, (*key, name))
            elif name in ("until", "expect"):
                check_conditions(document, each, (*key, name))


def _check_syntax(document: Document, text: str, key: Key) -> None:
    hint = ""
    try:
        compiled(text.strip())
        known = {*_NAMES, *CONDITION_NAMES}
        unknown = next((each for each in free_names(text.strip()) if each not in known), None)
        if unknown is None:
            return
        reason = f'"{unknown}" is not defined'
        hint = f"{suggestion(unknown, CONDITION_NAMES)} {NAME_HINT}"
    except SyntaxError as error:
        reason = error.msg
    except CartwheelError as error:
        reason, hint = error.message, error.hint or ""
    except ValueError as error:
        reason = str(error)
    message = f'the expression "{text}" cannot be evaluated: {reason}'
    raise _failure(document, key, message, text, hint)


def _failure(document: Document, key: Key, message: str, text: str, hint: str) -> CartwheelError:
    failure = document.error(key, message, hint=hint, values={"expression": text})
    failure.code = SCENARIO_EXPRESSION
    return failure
