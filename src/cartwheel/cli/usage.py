"""Wrong usage of the command line, as the parser of its arguments reports it."""

from __future__ import annotations

import click

from cartwheel.cli.showing import print_diagnostic
from cartwheel.codes.command import OPTION_INVALID, USAGE
from cartwheel.errors import Diagnostic


def is_wrong(error: Exception) -> bool:
    """Whether the parser raised an error."""
    return isinstance(error, click.ClickException | click.Abort)


def report(error: Exception) -> int:
    """Prints what is wrong; returns the status."""
    if isinstance(error, click.exceptions.NoArgsIsHelpError):
        error.show()
        return error.exit_code
    if isinstance(error, click.ClickException):
        print_diagnostic(_diagnostic(error))
        return error.exit_code
    return 1


def _diagnostic(error: click.ClickException) -> Diagnostic:
    """Here alone the parser's texts are put into ours."""
    hints = []
    if isinstance(error, click.NoSuchOption) and error.possibilities:
        text = error.message
        hints.append(f"Did you mean {' or '.join(sorted(error.possibilities))}?")
    else:
        text = error.format_message()
    context = getattr(error, "ctx", None)
    if context is not None:
        hints.append(f"See: {context.command_path} --help")
    parameter = getattr(error, "param", None)
    is_value = isinstance(error, click.BadParameter)
    missing = isinstance(error, click.MissingParameter)
    return (OPTION_INVALID if is_value and not missing else USAGE).diagnostic(
        f"{text[:1].lower()}{text[1:].rstrip('.')}",
        hint=" ".join(hints),
        values={
            "command": context.command_path if context is not None else "",
            "parameter": parameter.name if parameter is not None else "",
        },
    )
