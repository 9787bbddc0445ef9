"""What xacro complains about, said with its place, what is allowed, and the likely typo."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from cartwheel.description import numbers
from cartwheel.description.xml import near_files
from cartwheel.errors import DescriptionError, Origin, suggestion


@dataclass(frozen=True, kw_only=True, slots=True)
class Failure:
    """An exception of xacro and what was defined where it happened."""

    error: Exception
    origin: Origin
    call: Origin | None
    """Of the innermost macro call in progress."""
    call_tag: str
    macros: tuple[str, ...]
    properties: tuple[str, ...]
    arguments: tuple[str, ...]
    parameters: tuple[str, ...]
    """Of the macro called."""


_LONGEST = 4000
"""Characters of an error that are looked at."""

_UNDEFINED = re.compile(r"name '([^']*)' is not defined")
_MACRO = re.compile(r"unknown macro name: xacro:(\S+)")
_ARGUMENT = re.compile(r"Undefined substitution argument '?([\w.-]+)")
_BLOCK = re.compile(r'Undefined block "([^"]*)"')
_PARAMETER = re.compile(r'Invalid parameter "([^"]*)"')
_MISSING = re.compile(r"Undefined parameters \[([^\]]*)\]")
_CONDITION = re.compile(r'Xacro conditional "(.*)" evaluated to "(.*)", which is not', re.DOTALL)
_ATTRIBUTE = re.compile(r"(\S+): missing attribute '([^']*)'")
_COMMAND = re.compile(r"Unknown substitution command \[(\S+)")
_ENVIRONMENT = re.compile(r"environment variable '([^']*)' is not set")
_EXPRESSION = re.compile(r"when evaluating expression '(.*?)'\s*(?:\Z|when evaluating)", re.DOTALL)


def explain(failure: Failure) -> DescriptionError:
    """The error to show for a failed expansion."""
    # What an error quotes may be as long as the file.
    text = str(failure.error)[:_LONGEST] or type(failure.error).__name__
    inner = _innermost(failure.error)
    origin = failure.origin
    message, hint = text.splitlines()[0], None

    if isinstance(inner, RecursionError):
        return DescriptionError(
            "macros, includes or properties use each other without end",
            origin=Origin(file=origin.file, line=origin.line, stack=origin.stack[:6]),
        )
    if isinstance(inner, FileNotFoundError):
        message = f'the included file "{inner.filename}" does not exist'
        hint = near_files(Path(str(inner.filename)))
    elif match := _MACRO.search(text):
        message = f"unknown macro name: xacro:{match[1]}"
        hint = _meant(f"xacro:{match[1]}", [f"xacro:{name}" for name in failure.macros])
        if not failure.macros:
            hint = "No macro is defined here. Is a xacro:include missing?"
    elif match := _UNDEFINED.search(text):
        message = f'the property "{match[1]}" is not defined' + _expression(text)
        hint = _meant(match[1], [*failure.properties, *_FUNCTIONS])
        if match[1] in failure.arguments:
            hint = f"It is an argument: write $(arg {match[1]})."
    elif match := _ARGUMENT.search(text):
        hint = _meant(match[1], failure.arguments)
        message = f'the argument "{match[1]}" {"is not declared" if hint else "has no value"}'
        hint = hint or (
            f"Give it one on the command line, {match[1]}:=…, or in the file: "
            f'<xacro:arg name="{match[1]}" default="…"/>.'
        )
    elif match := _BLOCK.search(text):
        message = f'the block "{match[1]}" is not defined'
        hint = _meant(match[1], failure.properties)
    elif match := _PARAMETER.search(text):
        message = f'{failure.call_tag} has no parameter "{match[1]}"'
        hint = suggestion(match[1], failure.parameters)
        origin = failure.call or origin
    elif match := _MISSING.search(text):
        names = ", ".join(f'"{name}"' for name in match[1].split(","))
        message = f"{failure.call_tag} is called without its parameter {names}"
        origin = failure.call or origin
    elif text.startswith(("Not enough blocks", "Unused block")):
        message = f"{failure.call_tag}: {message[0].lower()}{message[1:]}"
        hint = "A macro takes one element in the call for each of its parameters with a *."
        origin = failure.call or origin
    elif match := _CONDITION.search(text):
        message = f'the condition "{match[1]}" is "{match[2]}", which is neither true nor false'
    elif match := _ATTRIBUTE.search(text):
        message = f'<{match[1]}> has no attribute "{match[2]}"'
    elif match := _COMMAND.search(text):
        message = f"$({match[1]} …) is not known"
        hint = suggestion(match[1], ["arg", "find", "env", "optenv", "dirname", "eval", "cwd"])
    elif match := _ENVIRONMENT.search(text):
        message = f'the environment variable "{match[1]}" is not set'
        hint = f"$(optenv {match[1]} default) takes a default where it is not."
    elif _EXPRESSION.search(text):
        reason = str(inner).splitlines()[0] if str(inner) else type(inner).__name__
        reason = reason.replace("(<expression>, line 1)", "").strip()
        message = f"{reason}{_expression(text)}"
    elif isinstance(inner, IndexError | KeyError | AttributeError | AssertionError):
        message = f"xacro fails at this element: {type(inner).__name__}: {inner}"
    return DescriptionError(message, origin=origin, hint=hint)


_FUNCTIONS = ("pi", "sin", "cos", "tan", "sqrt", "radians", "degrees", "atan2", "abs", "load_yaml")


def _innermost(error: BaseException) -> BaseException:
    for _ in range(50):
        inner = getattr(error, "exc", None)
        if not isinstance(inner, BaseException):
            break
        error = inner
    return error


def _expression(text: str) -> str:
    match = _EXPRESSION.search(text)
    return f", when evaluating ${{{match[1].strip()}}}" if match else ""


def _meant(name: str, known: list[str] | tuple[str, ...]) -> str | None:
    near = numbers.likely(name, known)
    return f'Did you mean "{near}"?' if near else None
