"""Files of which a part of the name or the folder is unknown, and what else YAML files may be."""

from __future__ import annotations

import re
from pathlib import Path

from cartwheel import yaml_text
from cartwheel.description.files.package_folders import is_file
from cartwheel.description.files.repositories import repository_of
from cartwheel.errors import CartwheelError

SUFFIXES = (".xacro", ".urdf", ".sdf", ".gazebo")
"""Ends of the names of descriptions."""
_FIRST_KEY = re.compile(r"^( *)(?!---|[\s#%])", re.MULTILINE)
"""The indentation of a YAML file's first key, which is that of all keys of the same mapping."""


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


def only_beside(file: Path, word: str, suffixes: tuple[str, ...]) -> Path | None:
    """The only file that may be meant, if a part of the name of a file is unknown; see `beside`."""
    if word not in file.name or word in str(file.parent) or not is_telling(file, word):
        return None
    found = list(beside(file, word, suffixes))
    return found[0] if len(found) == 1 else None


def is_telling(file: Path, word: str) -> bool:
    """Whether enough of a file's name is known, without a word, that others may be meant."""
    return re.search(r"\w{3}", file.stem.replace(word, " ")) is not None


def is_single(file: Path) -> bool:
    """Whether a YAML file contains the parameters of a single controller."""
    try:
        text = yaml_text.read(file)
    except (CartwheelError, OSError, UnicodeDecodeError):
        return False
    first = _FIRST_KEY.search(text)
    indentation = "" if first is None else first[1]
    return re.search(rf"^{indentation}[\"']?type[\"']?[ \t]*:", text, re.MULTILINE) is not None


def model_in(folder: Path | None, name: str) -> Path | None:
    """The SDF of a model in a package, which may have a folder for its models."""
    if folder is None or not re.fullmatch(r"[\w.-]+", name):
        return None
    files = (each / name / "model.sdf" for each in (folder / "models", folder))
    return next((each for each in files if is_file(each)), None)
