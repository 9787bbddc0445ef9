"""Functions that launch files in Python take from other files, and texts that they format."""

from __future__ import annotations

import ast
import string
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from cartwheel.description.files.regular_files import read_regular_text
from cartwheel.description.launches.effort import UNKNOWN, Effort
from cartwheel.description.launches.python_values import concatenated, text

LOADER = "load_python_launch_file_as_module"
"""A function of launch that imports a file."""


class Module:
    """A Python file that a launch file imports.

    Args:
        path: The file.
        effort: What reading it may cost.
    """

    def __init__(self, path: Path, effort: Effort) -> None:
        self.functions: dict[str, ast.FunctionDef] = {}
        try:
            content = read_regular_text(path)
            effort.spend(len(content))
            tree = ast.parse(content)
        except (OSError, SyntaxError, ValueError, RecursionError, MemoryError):
            return
        found = (each for each in tree.body if isinstance(each, ast.FunctionDef))
        self.functions = {each.name: each for each in found}


def formatted(pattern: str, places: Sequence[Any], words: Mapping[str, Any]) -> str:
    """The text that ``str.format`` returns; an unknown one if a part of it is unknown."""
    found: list[str] = []
    following = 0
    try:
        for plain, name, form, conversion in string.Formatter().parse(pattern):
            found.append(plain)
            if name is None:
                continue
            stated = name or str(following)
            following += not name
            value = words.get(stated, UNKNOWN)
            if stated.isdecimal() and int(stated) < len(places):
                value = places[int(stated)]
            found.append(text(value) if not (form or conversion) else UNKNOWN)
    except ValueError:
        return UNKNOWN
    return concatenated(found)
