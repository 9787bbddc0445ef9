"""Descriptions whose file names differ only in a word."""

from __future__ import annotations

import re
from pathlib import Path

from cartwheel.description.files.package_folders import is_file

SUFFIXES = (".xacro", ".urdf", ".sdf", ".gazebo")
"""Ends of the names of descriptions."""


def beside(file: Path, word: str) -> dict[Path, str]:
    """The descriptions in a file's folder whose names differ from its name only in a word.

    Returns:
        What stands for the word, by file.
    """
    first, *rest = (re.escape(part) for part in file.name.split(word))
    if not rest:
        return {}
    pattern = re.compile(first + r"(?P<word>[\w.-]+)" + "(?P=word)".join(rest))
    try:
        names = sorted(each.name for each in file.parent.iterdir())
    except OSError:
        return {}
    return {
        file.parent / name: found["word"]
        for name in names
        if name.endswith(SUFFIXES)
        and (found := pattern.fullmatch(name)) is not None
        and is_file(file.parent / name)
    }
