"""Converts errors and warnings of the xacro package: adds codes, locations and suggestions.

Only this module parses the package's messages.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from cartwheel.codes import files as codes
from cartwheel.description.elements import numbers
from cartwheel.description.elements.xml import near_files, readable_file
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
    files: tuple[str, ...]
    """The files read so far."""


class ArgumentError(Exception):
    """An argument in ``$(arg …)`` without a value.

    Args:
        name: Its name.
    """

    def __init__(self, name: str) -> None:
        super().__init__(name)
        self.name = name


_LONGEST = 4000
"""Maximum characters of an error message to examine."""

_LONGEST_CYCLE, _TURNS = 16, 4
"""Most files that include each other, and how often they must do so at the end of the list."""
_UNDEFINED = re.compile(r"name '([^']*)' is not defined")
_MACRO = re.compile(r"unknown macro name: xacro:(\S+)")
_BLOCK = re.compile(r'Undefined block "([^"]*)"')
_PARAMETER = re.compile(r'Invalid parameter "([^"]*)"')
_MISSING = re.compile(r"Undefined parameters \[([^\]]*)\]")
_CONDITION = re.compile(r'Xacro conditional "(.*)" evaluated to "(.*)", which is not', re.DOTALL)
_ATTRIBUTE = re.compile(r"(\S+): missing attribute '([^']*)'")
_COMMAND = re.compile(r"Unknown substitution command \[(\S+)")
_ENVIRONMENT = re.compile(r"environment variable '([^']*)' is not set")


def explain(failure: Failure) -> DescriptionError:
    """The error to report for a failed expansion."""
    # The error may quote a text as long as the file.
    text = str(failure.error)[:_LONGEST] or type(failure.error).__name__
    inner = list(_chain(failure.error))[-1]
    expression = _expression(failure.error)
    evaluated = f" (in the expression ${{{expression}}})" if expression else ""
    origin = failure.origin
    message, hint = text.splitlines()[0], None
    code: Code = codes.XACRO_INVALID
    values: dict[str, Value] = {}

    if isinstance(inner, RecursionError):
        cycle = _cycle(failure.files)
        if cycle:
            others = f"{len(cycle) - 1} other file{'s' if len(cycle) > 2 else ''}"
            through = f", through {others}" if len(cycle) > 1 else ""
            return DescriptionError(
                f'"{cycle[0]}" includes itself{through}',
                code=codes.INCLUDE_RECURSIVE,
                values={"file": cycle[0], "length": len(cycle)},
                origin=Origin(file=origin.file, line=origin.line),
                hint="xacro fails as well. Remove the include.",
            )
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
    elif isinstance(inner, NameError) and (name := _undefined(inner)):
        message = f'the property "{name}" is not defined{evaluated}'
        hint, near = _meant(name, [*failure.properties, *_FUNCTIONS])
        if name in failure.arguments:
            hint = f"{name} is an argument: use $(arg {name})."
        code, values = _unknown("property", name, near)
        values["expression"] = expression
        later = _defined_later(name, failure)
        if later is not None:
            hint = f"It is defined later, at {later}. Move the definition above this line."
            values |= {"meant": name, "defined": str(later)}
    elif isinstance(inner, ArgumentError):
        name = inner.name
        hint, near = _meant(name, failure.arguments)
        message = f'the argument "{name}" {"is not declared" if hint else "has no value"}'
        # A launch file may pass arguments that the file does not declare.
        hint = f"{hint} Otherwise, pass".lstrip() if hint else "Pass"
        hint += (
            f" {xacro_argument(name)}, or set a default in the file: <xacro:arg "
            f'name="{name}" default="…"/>.'
        )
        code, values = _unknown("argument", name, near)
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
    elif expression:
        reason = inner.msg if isinstance(inner, SyntaxError) else str(inner)
        reason = (reason.splitlines() or [type(inner).__name__])[0]
        message = f"{reason}{evaluated}"
        code = codes.EXPRESSION_INVALID
        values = {"cause": type(inner).__name__, "expression": expression}
    elif isinstance(inner, IndexError | KeyError | AttributeError | AssertionError):
        message = f"xacro fails at this element: {type(inner).__name__}: {inner}"
    return DescriptionError(message, code=code, origin=origin, hint=hint, values=values)


def _unknown(kind: str, name: str, near: str) -> tuple[Code, dict[str, Value]]:
    return codes.XACRO_NAME_UNKNOWN, {"kind": kind, "name": name, "meant": near}


_COMMANDS = ("arg", "find", "env", "optenv", "dirname", "eval", "cwd")
_FUNCTIONS = ("pi", "sin", "cos", "tan", "sqrt", "radians", "degrees", "atan2", "abs", "load_yaml")


def _cycle(files: Sequence[str]) -> Sequence[str]:
    """The files that included each other again and again at the end; empty if there are none."""
    for length in range(1, _LONGEST_CYCLE + 1):
        last = files[-length:]
        times = [files[len(files) - n * length :][:length] for n in range(1, _TURNS + 1)]
        if len(files) >= _TURNS * length and all(each == last for each in times):
            return last
    return ()


def _chain(error: BaseException) -> Iterator[BaseException]:
    """The error, and those that xacro wrapped in it."""
    for _ in range(50):
        yield error
        inner = getattr(error, "exc", None)
        if not isinstance(inner, BaseException):
            return
        error = inner


def _expression(error: BaseException) -> str:
    """The innermost expression that failed; empty if none did."""
    return next(
        (each.expression for each in reversed(list(_chain(error))) if hasattr(each, "expression")),
        "",
    )


def _defined_later(name: str, failure: Failure) -> Origin | None:
    """Where a property is defined that does not exist yet where it is used; None if nowhere.

    Definitions in macros are local to a call, so they do not count.
    """
    for file in dict.fromkeys((failure.origin.file, *failure.files)):
        root = readable_file(Path(file))
        level = [root] if root is not None else []
        while level:
            for node in level:
                if node.tag == "xacro:property" and node.attributes.get("name") == name:
                    return node.origin
            level = [
                child for node in level if node.tag != "xacro:macro" for child in node.children
            ]
    return None


def _undefined(error: NameError) -> str:
    """The name that is not defined. In a namespace, only the message of xacro contains it."""
    match = _UNDEFINED.search(str(error))
    return error.name or (match[1] if match else "")


def _meant(name: str, known: list[str] | tuple[str, ...]) -> tuple[str | None, str]:
    """A hint with the suggested name, and that name."""
    near = numbers.likely(name, known)
    return (f'Did you mean "{near}"?', near) if near else (None, "")
