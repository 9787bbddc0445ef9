"""Errors of the argument parser."""

from __future__ import annotations

from typing import Any

import typer

from cartwheel.cli.showing import print_diagnostic
from cartwheel.codes.command import OPTION_INVALID, USAGE
from cartwheel.errors import Diagnostic

# Releases of typer differ in whether click is separate or included.
_PARSER_ERROR: type[Exception] = typer.BadParameter.__mro__[2]


def is_wrong(error: Exception) -> bool:
    """Whether an error comes from the parser."""
    return isinstance(error, _PARSER_ERROR | typer.Abort)


def report(error: Exception) -> int:
    """Prints an error; returns the status."""
    if isinstance(error, typer.Abort):
        return 1
    parser_error: Any = error
    if _is(error, "NoArgsIsHelpError"):
        parser_error.show()
    else:
        print_diagnostic(_diagnostic(parser_error))
    return int(parser_error.exit_code)


def _diagnostic(error: Any) -> Diagnostic:
    """Only this function converts the parser's messages."""
    hints = []
    possible = getattr(error, "possibilities", None)
    if possible:
        hints.append(f"Did you mean {' or '.join(sorted(possible))}?")
    text = " ".join((error.message if possible else error.format_message()).split())
    context = getattr(error, "ctx", None)
    command = context.command_path if context is not None else ""
    if command:
        hints.append(f"See: {command} --help")
    parameter = getattr(error, "param", None)
    is_value = isinstance(error, typer.BadParameter) and not _is(error, "MissingParameter")
    return (OPTION_INVALID if is_value else USAGE).diagnostic(
        f"{text[:1].lower()}{text[1:].rstrip('.')}",
        hint=" ".join(hints),
        values={"command": command, "parameter": getattr(parameter, "name", None) or ""},
    )


def _is(error: Exception, name: str) -> bool:
    return any(kind.__name__ == name for kind in type(error).__mro__)
