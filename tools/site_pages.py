"""Pages of the site that are written from the program: commands, diagnostic codes, the Python API.

They are made at each build and are not in the repository: `cartwheel --help` and `cartwheel
explain` show the same without a site.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import typer

import cartwheel
from cartwheel.cli import help as sections
from cartwheel.cli.app import app
from cartwheel.codes import MODULES, all_codes, codes_of, explanation
from cartwheel.errors import Code

COMMANDS, CODES, API = "commands/index.md", "codes/index.md", "api.md"
SEVERITIES = {"error": "Error", "warning": "Warning", "info": "Informational message"}

_CODES_INTRODUCTION = """\
# Diagnostic codes

Every error, warning and note of Cartwheel has a code. A code keeps its number and its name in all
later versions. `cartwheel explain` shows the same pages in a terminal:

```console
$ cartwheel explain CW204
```
"""

_PACKAGES = ("batch", "dataset", "gym", "sweeps", "testing")
"""Packages with public names of their own."""
_API_INTRODUCTION = """\
# Python API

The public names of the package `cartwheel`, the diagnostics that they report, and the packages for
batches, datasets, environments, parameter studies and tests.
[From Python](python.md) shows how to use them.
"""

_PLUGIN_API = """\
# Plugin API

The base class of plugins, and the fields of their parameters. A package adds plugins through the
entry point group `cartwheel.plugins`.

::: cartwheel.dialects.plugin.Plugin

::: cartwheel.dialects.tags.tag
"""


def pages() -> dict[str, str]:
    """The text of each page, by its path on the site."""
    return {**_command_pages(), **_code_pages(), API: _api_page(), "plugin-api.md": _PLUGIN_API}


def command_page(name: str) -> str:
    """The path of a command's page."""
    return f"commands/{name}.md"


def code_page(code: Code) -> str:
    """The path of a code's page."""
    return f"codes/{code.number}.md"


def _command_pages() -> dict[str, str]:
    program: Any = typer.main.get_command(app)
    context = program.context_class(program, info_name="cartwheel")
    made, groups = {}, dict[str, list[str]]()
    for name, command in program.commands.items():
        inner = command.context_class(command, info_name=name, parent=context)
        lines = [f"# cartwheel {name}", "", *_command(command, inner, "##")]
        for other, child in getattr(command, "commands", {}).items():
            place = child.context_class(child, info_name=other, parent=inner)
            lines += [f"## cartwheel {name} {other}", "", *_command(child, place, "###")]
        made[command_page(name)] = "\n".join(lines)
        row = f"| [`cartwheel {name}`]({name}.md) | {_cell(_summary(command))} |"
        groups.setdefault(command.rich_help_panel or "Commands", []).append(row)
    index = ["# Commands", "", _markdown(program.help), ""]
    for title, rows in groups.items():
        index += [f"## {title}", "", "| Command | Purpose |", "|---|---|", *rows, ""]
    index += [*_options(program, context, "##"), ""]
    return {COMMANDS: "\n".join(index), **made}


def _summary(command: Any) -> str:
    """The first sentence of its help."""
    return str(command.get_short_help_str(1000))


def _command(command: Any, context: Any, level: str) -> Iterator[str]:
    yield from (_markdown(command.help or ""), "")
    yield from ("```text", command.get_usage(context).removeprefix("Usage: "), "```", "")
    rows = [sections.argument_record(each) for each in sections.arguments(command, context)]
    if any(text for _, text in rows):
        yield from (f"{level} Arguments", "", *_table("Argument", rows), "")
    if not hasattr(command, "commands"):
        yield from _options(command, context, level)


def _options(command: Any, context: Any, level: str) -> Iterator[str]:
    for title, rows in sections.option_sections(command, context).items():
        if rows:
            yield from (f"{level} {title}", "", *_table("Option", rows), "")


def _table(heading: str, rows: list[tuple[str, str]]) -> Iterator[str]:
    yield from (f"| {heading} | Meaning |", "|---|---|")
    for name, text in rows:
        yield f"| `{name}` | {_cell(text)} |"


def _cell(text: str) -> str:
    return _markdown(text).replace("|", "\\|").replace("\n", " ")


def _markdown(text: str) -> str:
    """Plain text as Markdown that shows the same characters."""
    return re.sub(r"([\\`*_<\[\]])", r"\\\1", text)


def _code_pages() -> dict[str, str]:
    index = [_CODES_INTRODUCTION]
    for module, title in MODULES.items():
        index += [f"## {title}", "", "| Code | Name | Severity | Summary |", "|---|---|---|---|"]
        for code in codes_of(module):
            link = f"[{code.number}]({code.number}.md)"
            summary = _cell(code.summary)
            index.append(f"| {link} | `{code.name}` | {code.severity} | {summary} |")
        index.append("")
    made = {code_page(code): _code(code) for code in all_codes()}
    return {CODES: "\n".join(index), **made}


def _code(code: Code) -> str:
    kind = "failure" if code.severity == "error" else code.severity
    lines = [
        f"# {code}",
        "",
        f'!!! {kind} "{SEVERITIES[code.severity]}"',
        "",
        f"    {_sentence(code.summary)}",
        "",
        _raised(explanation(code)),
        "",
        "[All diagnostic codes](index.md)",
        "",
    ]
    return "\n".join(lines)


def _sentence(text: str) -> str:
    return _markdown(f"{text[0].upper()}{text[1:]}.")


def _raised(text: str) -> str:
    """The explanation with each heading one level higher: the page has a title of its own."""
    parts = re.split(r"(^```.*?^```)", text, flags=re.MULTILINE | re.DOTALL)
    parts[::2] = [re.sub(r"^###", "##", part, flags=re.MULTILINE) for part in parts[::2]]
    return "".join(parts)


def _api_page() -> str:
    names = sorted(cartwheel.__all__, key=_importance)
    names += ["errors.Diagnostic", "errors.Code", "errors.Origin"]
    for package in _PACKAGES:
        names += [f"{package}.{name}" for name in _public(package)]
    return "\n".join([_API_INTRODUCTION, *(f"::: cartwheel.{name}\n" for name in names)])


def _public(package: str) -> list[str]:
    """``__all__`` of a package, which may import what is not installed."""
    source = Path(cartwheel.__file__).parent / package / "__init__.py"
    for statement in ast.parse(source.read_text()).body:
        if isinstance(statement, ast.Assign) and ast.unparse(statement.targets[0]) == "__all__":
            found: list[str] = ast.literal_eval(statement.value)
            return found
    raise ValueError(f"{source} has no __all__")


def _importance(name: str) -> tuple[bool, bool, str]:
    """`World` first, then other classes, errors last."""
    return name.endswith("Error"), name != "World", name
