"""``--help``: options and commands in groups, as plain text.

An option or command belongs to the group that its ``rich_help_panel`` names. Typer draws such
groups as boxes; here they are sections, which any terminal, pipe and screen reader can show.
"""

from __future__ import annotations

from typing import Any

import typer
from typer.core import TyperCommand, TyperGroup

SIMULATE = "Simulate and view"
CONTROL = "Control a running simulation"
FILES = "Check and convert files"
OTHER = "Other commands"

WORLD = "World"
ROBOT = "Robot"
TIME = "Time"
PAGE = "Web interface"
WIRES = "ROS and Foxglove"
RECORDING = "Recording"
LOOKUP = "Files and folders"
REPORT = "Report"

_GENERAL = "Options"


class Command(TyperCommand):
    """A command whose help has a section for each group of options."""

    def collect_usage_pieces(self, ctx: Any) -> list[str]:
        """The words of the usage line; brackets in an argument's metavar mark optional words."""
        return [str(self.options_metavar), *(a.metavar or a.name for a in arguments(self, ctx))]

    def format_options(self, ctx: Any, formatter: Any) -> None:
        """Writes the sections."""
        _write(formatter, {"Arguments": [argument_record(a) for a in arguments(self, ctx)]})
        _write(formatter, option_sections(self, ctx))


class Group(TyperGroup):
    """A command with subcommands, in a section for each group."""

    def format_options(self, ctx: Any, formatter: Any) -> None:
        """Writes the sections."""
        sections: dict[str, list[tuple[str, str]]] = {}
        width = formatter.width - 6 - max(map(len, self.commands))
        for name, command in self.commands.items():
            title = getattr(command, "rich_help_panel", None) or "Commands"
            sections.setdefault(title, []).append((name, command.get_short_help_str(width)))
        _write(formatter, sections)
        _write(formatter, option_sections(self, ctx))


def option(usage: str, text: str, group: str | None = None, **more: Any) -> Any:
    """An option of a command, for ``Annotated``.

    Args:
        usage: The flags and the placeholder of the value, as in the help: ``-n --count N``.
        text: What the option does.
        group: The section of the help; by default the general options.
        **more: Passed to ``typer.Option``.
    """
    words = usage.split()
    flags = [word for word in words if word.startswith("-")]
    metavar = " ".join(words[len(flags) :]) or None
    return typer.Option(*flags, metavar=metavar, help=text, rich_help_panel=group, **more)


def argument(metavar: str, text: str, **more: Any) -> Any:
    """An argument of a command, for ``Annotated``. The placeholder has brackets if optional."""
    return typer.Argument(metavar=metavar, help=text, **more)


def arguments(command: Any, ctx: Any) -> list[Any]:
    """The arguments of a command, without its options."""
    return [p for p in command.get_params(ctx) if p.param_type_name == "argument"]


def argument_record(argument: Any) -> tuple[str, str]:
    """The name of an argument, and its help."""
    return argument.metavar or argument.name, argument.help or ""


def option_sections(command: Any, ctx: Any) -> dict[str, list[tuple[str, str]]]:
    """The options by group, in the order of the parameters; those without a group come last."""
    sections: dict[str, list[tuple[str, str]]] = {}
    general: list[tuple[str, str]] = []
    for option in command.get_params(ctx):
        record = option.get_help_record(ctx)
        if record is None or option.param_type_name == "argument":
            continue
        group = getattr(option, "rich_help_panel", None)
        (sections.setdefault(group, []) if group else general).append(record)
    return {**sections, _GENERAL: general}


def _write(formatter: Any, sections: dict[str, list[tuple[str, str]]]) -> None:
    for title, records in sections.items():
        if records:
            with formatter.section(title):
                formatter.write_dl([(name, text or " ") for name, text in records])
