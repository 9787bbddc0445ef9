"""Explanations of diagnostic codes, for people and for programs."""

from __future__ import annotations

import json as json_module
import sys
from collections.abc import Sequence

from cartwheel.cli.console import is_terminal, paint, say, table
from cartwheel.codes import MODULES, all_codes, code_named, codes_of, explanation
from cartwheel.errors import Code


def explain(names: Sequence[str], *, json: bool) -> None:
    """Prints explanations of codes; lists all codes without arguments.

    Args:
        names: Numbers or names of codes.
        json: Whether to print a JSON array with the ``text`` of each code in Markdown.

    Raises:
        UnknownNameError: A code does not exist.
    """
    chosen = [code_named(name) for name in names] or list(all_codes())
    if json:
        entries = [_entry(code) for code in chosen]
        say(json_module.dumps(entries, indent=2))
    elif names:
        for code in chosen:
            _print(code)
    else:
        for module, title in MODULES.items():
            if codes_of(module):
                say(paint(title, "bold"))
                rows = [(code.number, code.name, code.summary) for code in codes_of(module)]
                say(table(rows, indent="  ") + "\n")


def _entry(code: Code) -> dict[str, str]:
    return {
        "code": code.number,
        "name": code.name,
        "severity": code.severity,
        "summary": code.summary,
        "text": explanation(code),
    }


def _print(code: Code) -> None:
    text = f"# {code}\n\n{explanation(code)}\n"
    if not is_terminal(sys.stdout):
        say(text)
        return
    from rich.console import Console
    from rich.markdown import Markdown

    Console().print(Markdown(text))
