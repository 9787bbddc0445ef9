"""Descriptions whose file names differ only in a word, or whose folder is unknown."""

from __future__ import annotations

import re
from pathlib import Path

from cartwheel.description.files.package_folders import is_file
from cartwheel.description.files.repositories import repository_of

SUFFIXES = (".xacro", ".urdf", ".sdf", ".gazebo")
"""Ends of the names of descriptions."""


def beside(file: Path, word: str, suffixes: tuple[str, ...] = SUFFIXES) -> dict[Path, str]:
    """The descriptions in a file's folder whose names differ from its name only in a word.

    Args:
        file: The file.
        word: The word.
        suffixes: Ends of the names, for other files than descriptions.

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
        if name.endswith(suffixes)
        and (found := pattern.fullmatch(name)) is not None
        and is_file(file.parent / name)
    }


def below(file: Path, unknown: str, launch: Path) -> Path | None:
    """The file in a folder whose place is unknown, such as ``$(env HOME)/bot/urdf/bot.urdf``.

    Args:
        file: The path, which begins with the unknown part.
        unknown: The text that stands for it.
        launch: The launch file. The folder is one of those around it, within its repository, if it
            contains the rest of the path, with at least one folder.
    """
    before, _, rest = str(file).rpartition(unknown)
    parts = Path(rest.lstrip("/")).parts
    root = repository_of(launch)
    if before or not rest.startswith("/") or len(parts) < 2 or root is None:
        return None
    folders = (each for each in launch.absolute().parents if each.is_relative_to(root))
    found = (each.joinpath(*parts) for each in folders)
    return next((each for each in found if is_file(each)), None)
