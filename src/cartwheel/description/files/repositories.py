"""The repository that contains a file.

Repositories of different authors may be side by side in one folder. What is only found near a file,
without being named, is used only within its own repository.
"""

from __future__ import annotations

from pathlib import Path

from cartwheel.description.files.nameless_packages import nameless_packages
from cartwheel.description.files.package_folders import around, is_file

_ROOT = (".git", ".github", ".gitmodules")
"""Entries that only the root of a repository contains."""
_LIKELY = (".gitignore", ".gitattributes")
"""Entries that folders in a repository may contain as well."""
MARKERS = (*_ROOT, *_LIKELY)
"""Entries of the root of a repository. An archive that was downloaded contains no ``.git``."""
_LEVELS = 4
"""Number of folders above a description that are searched for its package."""


def repository_of(file: Path, within: Path | None = None) -> Path | None:
    """The root of the repository that contains a file, by its hidden entries; None if unknown.

    A submodule belongs to the repository around it.

    Args:
        file: The file.
        within: Folders above this one are not searched, if it contains the file.
    """
    here = file.absolute().parent
    above = around(here)
    if within is not None and here.is_relative_to(within.absolute()):
        above = [each for each in above if each.is_relative_to(within.absolute())]
    outer = [each for each in above if (each / ".gitmodules").exists()]
    roots = [each for each in above if _has(each, _ROOT)]
    likely = [each for each in above if _has(each, _LIKELY)]
    return next(iter((*outer[-1:], *roots[:1], *likely[-1:])), None)


def root_of(description: Path) -> Path | None:
    """The folder with a description's package and the packages beside it; None outside of packages.

    Its launch files may start the description. A folder that stands for a package, although it has
    no package.xml, counts as well.
    """
    for folder in description.absolute().parents[:_LEVELS]:
        if is_file(folder / "package.xml") or is_file(folder / "manifest.xml"):
            return folder.parent if _has_others(folder) else folder
    return next(iter(nameless_packages(description.absolute()).values()), None)


def _has_others(folder: Path) -> bool:
    """Whether there are packages beside one; False if the folder above it may not be read."""
    try:
        beside = [each for each in folder.parent.iterdir() if each != folder]
    except OSError:
        return False
    return any(is_file(each / "package.xml") for each in beside)


def _has(folder: Path, names: tuple[str, ...]) -> bool:
    return any((folder / name).exists() for name in names)
