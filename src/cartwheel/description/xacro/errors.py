"""Converts errors and warnings of the xacro package: adds codes, locations and suggestions.

Only this module parses the package's messages.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from cartwheel.codes import files as codes
from cartwheel.description.elements import numbers
from cartwheel.description.elements.xml import near_files
from cartwheel.errors import Code, DescriptionError, Origin, Value
from cartwheel.options import xacro_argument
from cartwheel.similar_names import meant, suggestion


@dataclass(frozen=True, kw_only=True, slots=True)
class Failure:
    """An exception in xacro and the names defined at its location."""

    error: Exception
    origin: Origin
    call: Origin | None
    """Origin of the innermost active macro call."""
    call_tag: str
    macros: tuple[str, ...]
    properties: tuple[str, ...]
    arguments: tuple[str, ...]
    parameters: tuple[str, ...]
    """Parameters of the called macro."""


_LONGEST = 4000
"""Maximum characters of an error message to examine."""

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
    """The error to report for a failed expansion."""
    # The error may quote a text as long as the file.
    text = str(failure.error)[:_LONGEST] or type(failure.error).__name__
    inner = _innermost(failure.error)
    origin = failure.origin
    message, hint = text.splitlines()[0], None
    code: Code = codes.XACRO_INVALID
    values: dict[str, Value] = {}

    if isinstance(inner, RecursionError):
        return DescriptionError(
            "macros, includes or properties refer to each other in an endless loop",
            code=codes.EXPANSION_TOO_LARGE,
            values={"kind": "recursion"},
            origin=Origin(file=origin.file, line=origin.line, stack=origin.stack[:6]),
        )
    if isinstance(inner, FileNotFoundError):
        message = f'the included file "{inner.filename}" does not exist'
        near, hint = near_files(Path(str(inner.filename)))
        code = codes.FILE_MISSING
        values = {"kind": "file", "name": str(inner.filename), "meant": near}
    elif match := _MACRO.search(text):
        message = f'the macro "xacro:{match[1]}" is not defined'
        hint, near = _meant(f"xacro:{match[1]}", [f"xacro:{name}" for name in failure.macros])
        if not failure.macros:
            hint = "No macro is defined here. Is a xacro:include missing?"
        code, values = _unknown("macro", f"xacro:{match[1]}", near)
    elif match := _UNDEFINED.search(text):
        message = f'the property "{match[1]}" is not defined' + _expression(text)
        hint, near = _meant(match[1], [*failure.properties, *_FUNCTIONS])
        if match[1] in failure.arguments:
            hint = f"{match[1]} is an argument: use $(arg {match[1]})."
        code, values = _unknown("property", match[1], near)
        values["expression"] = _evaluated(text)
    elif match := _ARGUMENT.search(text):
        hint, near = _meant(match[1], failure.arguments)
        message = f'the argument "{match[1]}" {"is not declared" if hint else "has no value"}'
        hint = hint or (
            f"Pass {xacro_argument(match[1])}, or set a default in the file: <xacro:arg "
            f'name="{match[1]}" default="…"/>.'
        )
        code, values = _unknown("argument", match[1], near)
    elif match := _BLOCK.search(text):
        message = f'the block "{match[1]}" is not defined'
        hint, near = _meant(match[1], failure.properties)
        code, values = _unknown("block", match[1], near)
    elif match := _PARAMETER.search(text):
        message = f'{failure.call_tag} has no parameter "{match[1]}"'
        hint = suggestion(match[1], failure.parameters)
        origin = failure.call or origin
        code = codes.MACRO_CALL_INVALID
        values = {"name": match[1], "meant": meant(match[1], failure.parameters)}
    elif match := _MISSING.search(text):
        missing = match[1].split(",")
        names = ", ".join(f'"{name}"' for name in missing)
        message = f"{failure.call_tag} is called without its parameter {names}"
        origin = failure.call or origin
        code, values = codes.MACRO_CALL_INVALID, {"missing": tuple(missing)}
    elif text.startswith(("Not enough blocks", "Unused block")):
        message = f"{failure.call_tag}: {message[0].lower()}{message[1:]}"
        hint = "The call must contain one element for each macro parameter that starts with *."
        origin = failure.call or origin
        code = codes.MACRO_CALL_INVALID
    elif match := _CONDITION.search(text):
        message = f'the condition "{match[1]}" is "{match[2]}", which is neither true nor false'
    elif match := _ATTRIBUTE.search(text):
        message = f'<{match[1]}> has no attribute "{match[2]}"'
        values = {"tag": match[1], "missing": match[2]}
    elif match := _COMMAND.search(text):
        message = f"$({match[1]} …) is not a xacro command"
        hint = suggestion(match[1], _COMMANDS)
        code, values = _unknown("command", match[1], meant(match[1], _COMMANDS))
    elif match := _ENVIRONMENT.search(text):
        message = f'the environment variable "{match[1]}" is not set'
        hint = f"To use a default if it is not set: $(optenv {match[1]} default)."
        code, values = _unknown("environment variable", match[1], "")
    elif _EXPRESSION.search(text):
        reason = str(inner).splitlines()[0] if str(inner) else type(inner).__name__
        reason = reason.replace("(<expression>, line 1)", "").strip()
        message = f"{reason}{_expression(text)}"
        code, values = codes.EXPRESSION_INVALID, {"cause": type(inner).__name__}
        values["expression"] = _evaluated(text)
    elif isinstance(inner, IndexError | KeyError | AttributeError | AssertionError):
        message = f"xacro fails at this element: {type(inner).__name__}: {inner}"
    return DescriptionError(message, code=code, origin=origin, hint=hint, values=values)


def code_of(message: str) -> Code:
    """The code of a warning from xacro, or of a message printed by the description."""
    return codes.XACRO_DEPRECATED if "deprecated" in message else codes.XACRO_MESSAGE


def _unknown(kind: str, name: str, near: str) -> tuple[Code, dict[str, Value]]:
    return codes.XACRO_NAME_UNKNOWN, {"kind": kind, "name": name, "meant": near}


_COMMANDS = ("arg", "find", "env", "optenv", "dirname", "eval", "cwd")
_FUNCTIONS = ("pi", "sin", "cos", "tan", "sqrt", "radians", "degrees", "atan2", "abs", "load_yaml")


def _innermost(error: BaseException) -> BaseException:
    for _ in range(50):
        inner = getattr(error, "exc", None)
        if not isinstance(inner, BaseException):
            break
        error = inner
    return error


def _evaluated(text: str) -> str:
    """The expression that failed; empty if unknown."""
    match = _EXPRESSION.search(text)
    return match[1].strip() if match else ""


def _expression(text: str) -> str:
    evaluated = _evaluated(text)
    return f" (in the expression ${{{evaluated}}})" if evaluated else ""


def _meant(name: str, known: list[str] | tuple[str, ...]) -> tuple[str | None, str]:
    """A hint with the suggested name, and that name."""
    near = numbers.likely(name, known)
    return (f'Did you mean "{near}"?', near) if near else (None, "")
