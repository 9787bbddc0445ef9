"""Whether a file that a launch file names is certainly missing, and not only here."""

from __future__ import annotations

import contextlib
import os
import re
from collections.abc import Collection, Iterator
from dataclasses import replace
from fnmatch import fnmatch
from functools import cached_property
from pathlib import Path

from cartwheel.description.files.install_rules import source_of
from cartwheel.description.files.other_places import is_in_home
from cartwheel.description.files.package_folders import is_file, package_above
from cartwheel.description.files.readable_files import is_common
from cartwheel.description.files.regular_files import text_if_regular
from cartwheel.description.files.repositories import repository_of, root_of
from cartwheel.description.files.ros_version import ros_version
from cartwheel.description.files.source_folders import source_folders
from cartwheel.description.launches.effort import Effort
from cartwheel.description.launches.launch_use import Missing, MissingFile

_FOLDER = 100
"""Steps to list a folder."""
_MOST_FOLDERS = 5000
"""Maximum number of folders of a repository that are searched for a file."""
_SUBMODULE = re.compile(r"^[ \t]*path[ \t]*=[ \t]*(\S+)[ \t]*$", re.MULTILINE)
_BUILDING = ("CMakeLists.txt", "setup.py", "Makefile")
"""Files of a package that may make others."""
_TEMPLATES = (".xacro", ".in", ".em", ".erb", ".jinja", ".j2", ".template")
"""Ends of the names of files from which others are made."""
_MOST_LINES = 500
"""Maximum number of lines of a list of ignored files that are read."""
_OF_GAZEBO = re.compile(r"(?:worlds|media|models)/|~|\$|\w+:")
"""The beginning of the name of a world that may be one of Gazebo's own, or found elsewhere."""

_FOLDERS = "GAZEBO_RESOURCE_PATH"
"""The folders in which Gazebo Classic searches a world with a relative path."""


class Absence:
    """Decides which of the files that a launch file needs are certainly missing.

    They would be in a package of the launch file's own repository, or in a home folder, or are
    worlds with a name by which Gazebo finds none.

    Args:
        file: The launch file.
        included: The launch files that it includes.
        folders: The folders of packages in which it looks for files.
        effort: What looking for them may cost.
    """

    def __init__(
        self, file: Path, included: Collection[Path], folders: Collection[Path], effort: Effort
    ) -> None:
        self._file = file.absolute()
        self._included = included
        self._folders = [folder.absolute() for folder in folders]
        self._effort = effort

    def certain(self, missing: Collection[MissingFile]) -> Iterator[MissingFile]:
        """Those that are certainly missing, each once."""
        seen: set[str] = set()
        for each in missing:
            if each.name in seen:
                continue
            path = Path(os.path.normpath(each.name))
            if self._lacks(each.what, path):
                seen.add(each.name)
                yield each
            elif self._is_on_other_computer(path):
                seen.add(each.name)
                yield replace(each, at_home=True)

    def _lacks(self, what: Missing, path: Path) -> bool:
        if not path.is_absolute():
            return what == "world" and self._is_nowhere(path)
        package = self._package_of(path)
        return package is not None and self._is_missing_in(package, path)

    def _is_on_other_computer(self, path: Path) -> bool:
        """Whether an absolute path is stated that is in a home folder.

        On the author's computer, the packages are in a home folder as well.
        """
        own = (self._repository, self._file.parent.parent, *(each.parent for each in self._folders))
        near = any(each is not None and path.is_relative_to(each) for each in own)
        return is_in_home(str(path)) and not near

    def _is_nowhere(self, path: Path) -> bool:
        """Whether neither Gazebo nor the repository contains a world with a relative path."""
        if _OF_GAZEBO.match(str(path)) or ".." in path.parts or self._repository is None:
            return False
        # Launch files can add folders of other packages to those that Gazebo searches.
        for launch in dict.fromkeys((self._file, *self._included)):
            self._effort.spend(_FOLDER)
            if _FOLDERS in text_if_regular(launch):
                return False
        return not any(path.name in names for _, names in self._contents)

    def _package_of(self, path: Path) -> Path | None:
        """The package of the repository in which a file would be."""
        if self._repository is None:
            return None
        near = package_above(self._file.parent)
        for folder in (*([] if near is None else [near]), *self._folders):
            if path.is_relative_to(folder) and folder.is_relative_to(self._repository):
                return folder
        return None

    def _is_missing_in(self, package: Path, path: Path) -> bool:
        if is_file(path) or is_file(source_of(path)) or self._is_elsewhere(path):
            return False
        # ROS 2 finds the files where the package installs them.
        if ros_version(package / "package.xml") != 1 and any(
            path.name in names for _, names in self._contents
        ):
            return False
        return not self._is_made(package, path)

    def _is_elsewhere(self, path: Path) -> bool:
        """Whether a file is in a submodule, or of a kind that the repository does not contain."""
        root = self._repository
        assert root is not None
        text = text_if_regular(root / ".gitmodules")
        if any(path.is_relative_to(root / found[1]) for found in _SUBMODULE.finditer(text)):
            return True
        folder = next((each for each in path.parents if each.is_dir()), root)
        # Git keeps no empty folders, so it is one of a submodule, or is filled by hand.
        with contextlib.suppress(OSError):
            if not any(folder.iterdir()):
                return True
        ignored = "\n".join(
            text_if_regular(each / ".gitignore") for each in (root, *_between(root, path))
        )
        patterns = (line.strip().strip("/") for line in ignored.splitlines()[:_MOST_LINES])
        parts = path.relative_to(root).parts if path.is_relative_to(root) else path.parts
        return any(
            pattern and not pattern.startswith(("#", "!")) and _ignores(pattern, parts)
            for pattern in patterns
        )

    def _is_made(self, package: Path, path: Path) -> bool:
        """Whether a build, or the user, may make a file from another one."""
        stem = path.name.partition(".")[0]
        with contextlib.suppress(OSError):
            self._effort.spend(_FOLDER)
            for near in path.parent.iterdir():
                same = near.name.partition(".")[0] == stem and near.suffix in _TEMPLATES
                if same or near.name.startswith(f"{path.name}."):
                    return True
        named = re.compile(rf"(?<![\w.-]){re.escape(stem)}\.")
        return any(named.search(text_if_regular(package / name)) for name in _BUILDING)

    @cached_property
    def _repository(self) -> Path | None:
        """The folder with the files of the launch file's author."""
        found = repository_of(self._file) or root_of(self._file)
        return None if found is None or is_common(found) else found

    @cached_property
    def _contents(self) -> list[tuple[Path, list[str]]]:
        """The folders of the repository, with the names of their files."""
        found: list[tuple[Path, list[str]]] = []
        for folder, names in source_folders(self._repository or self._file.parent):
            self._effort.spend(_FOLDER + len(names))
            found.append((folder, names))
            if len(found) == _MOST_FOLDERS:
                break
        return found


def _between(root: Path, path: Path) -> list[Path]:
    """The folders between a repository and a file in it."""
    return [each for each in path.parents if each != root and each.is_relative_to(root)]


def _ignores(pattern: str, parts: tuple[str, ...]) -> bool:
    """Whether a pattern of ``.gitignore`` matches a file, or one of its folders."""
    if "/" in pattern:
        return fnmatch("/".join(parts), pattern) or fnmatch("/".join(parts), f"{pattern}/*")
    return any(fnmatch(part, pattern) for part in parts)
