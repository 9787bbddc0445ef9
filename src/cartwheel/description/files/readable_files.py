"""The files that an untrusted description may read with the user's permissions."""

from __future__ import annotations

import contextlib
import os
import tempfile
from collections.abc import Iterable, Iterator, Set
from dataclasses import dataclass, field
from pathlib import Path

from cartwheel.options import ALLOW_PATH

NAME_IT = (
    "A description may read files in its workspace and in packages, and files that you "
    "specify yourself."
)


def _allow() -> str:
    """The hint for clients of a simulation."""
    return (
        f"Start the simulation with {ALLOW_PATH.given('FOLDER')} to allow the folder of the file."
    )


@dataclass(frozen=True, kw_only=True, slots=True)
class Reach:
    """Files that a description received over the network may read, besides packages and models.

    None is used for a file that the user specified.
    """

    folders: tuple[Path, ...] = ()
    environment: bool = True
    """Whether ``$(env …)`` returns the values of environment variables."""
    hint: str = field(default_factory=_allow)


def real(path: Path) -> Path | None:
    """A path without links; None if it cannot exist."""
    try:
        return Path(os.path.realpath(path))
    except (OSError, ValueError):
        return None


def is_below(path: Path, folder: Path) -> bool:
    """Whether a path, with links resolved, is in a folder and in none of its hidden subfolders."""
    file, root = real(path), real(folder)
    if file is None or root is None or not file.is_relative_to(root):
        return False
    return not any(part.startswith(".") for part in file.relative_to(root).parts)


def with_targets(folders: Iterable[Path]) -> frozenset[Path]:
    """The folders by their names and, where links lead to them, by those of the links' targets."""
    names = set()
    for folder in folders:
        with contextlib.suppress(OSError, ValueError):
            names |= {folder.absolute(), Path(os.path.realpath(folder))}
    return frozenset(names)


def is_inside(path: Path, folders: Set[Path]) -> bool:
    """Whether a path is in a folder by its name; links in a trusted folder are allowed.

    ``..`` after a link is relative to the link's target.

    Args:
        path: The path.
        folders: The trusted folders, from `with_targets`.
    """
    try:
        parts = path.absolute().parts
        back = len(parts) - parts[::-1].index("..") if ".." in parts else 0
        file = Path(os.path.realpath(Path(*parts[:back])), *parts[back:]) if back else Path(*parts)
    except (OSError, ValueError):
        return False
    return file in folders or not folders.isdisjoint(file.parents)


def is_common(folder: Path) -> bool:
    """Whether a folder is shared by all users, so that it is not a workspace."""
    home = Path.home()
    common = {home, home.parent, Path(tempfile.gettempdir()), Path(folder.anchor)}
    return folder in common


def run_folders(files: Iterable[str]) -> Iterator[Path]:
    """The folders of a simulation: the working directory, and the folders of its files."""
    for folder in (Path.cwd(), *(Path(file).absolute().parent for file in files)):
        if not is_common(folder):
            yield folder


def is_named(path: Path, values: Iterable[str], folder: Path) -> bool:
    """Whether one of the user's arguments is a file, or a folder that contains it.

    Args:
        path: The file.
        values: Argument values.
        folder: Base folder for relative values, besides the current folder.
    """
    wanted = real(path)
    for value in values:
        text = value.removeprefix("file://")
        if "/" not in text or "\0" in text:
            continue
        for given in (Path(text).expanduser(), folder / text):
            meant = real(given)
            if meant is None:
                continue
            if meant == wanted:
                return True
            if len(meant.parts) > 2 and not is_common(meant) and is_below(path, meant):
                return True
    return False
