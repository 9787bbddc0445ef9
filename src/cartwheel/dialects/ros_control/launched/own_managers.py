"""Programs of a repository that contain a controller manager, such as drivers of real robots."""

from __future__ import annotations

import contextlib
import itertools
from pathlib import Path

from cartwheel.description.files.packages import Packages
from cartwheel.description.files.regular_files import read_start
from cartwheel.description.files.repositories import repository_of
from cartwheel.description.files.source_folders import source_folders
from cartwheel.description.launches import LaunchUse, root_of
from cartwheel.errors import DescriptionError

_SOURCES = (".cpp", ".cc", ".cxx", ".h", ".hpp", ".hh")
_MANAGER = b"ControllerManager"
"""The class. Source: controller_manager, of ROS 1 and ROS 2."""
_HEADER = b"controller_manager/controller_manager"
_MOST = 200
"""Maximum number of folders, and of files, that are searched."""
_LONGEST = 200_000
"""Number of bytes that are read of each file."""


def own_managers(use: LaunchUse | None) -> dict[str, str]:
    """The packages of the repository with a controller manager of which a launch file starts a
    program, by the namespace of the program.
    """
    if use is None:
        return {}
    repository = repository_of(use.file) or root_of(use.file)
    if repository is None:
        return {}
    packages = Packages(use.file)
    found: dict[str, str] = {}
    for space, package in itertools.islice(use.programs, _MOST):
        if space in found or not package.isidentifier():
            continue
        with contextlib.suppress(DescriptionError):
            folder = packages.find(package).resolve()
            if folder.is_relative_to(repository.resolve()) and _contains_manager(folder):
                found[space] = package
    return found


def _contains_manager(folder: Path) -> bool:
    """Whether a source file in a folder contains a controller manager."""
    paths = (
        here / name
        for here, names in itertools.islice(source_folders(folder), _MOST)
        for name in names
        if name.endswith(_SOURCES)
    )
    for path in itertools.islice(paths, _MOST):
        with contextlib.suppress(OSError):
            text = read_start(path, _LONGEST)
            if _MANAGER in text and _HEADER in text:
                return True
    return False
