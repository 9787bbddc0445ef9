"""Folders that are meant by the name of a package, although they contain no package.xml.

People publish the folder of a package without its package.xml, and the repository then has another
name than the package. The name is in CMakeLists.txt or setup.py, or in what the files of the folder
say about each other: ``$(find my_robot)/urdf/robot.urdf`` where ``urdf/robot.urdf`` exists.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator, Mapping
from pathlib import Path

from cartwheel.codes.files import PACKAGE_OF_NEIGHBOUR, PACKAGE_WITHOUT_MANIFEST
from cartwheel.description.files.package_folders import is_file, package_above, packages_in
from cartwheel.description.files.readable_files import is_common
from cartwheel.description.files.regular_files import text_if_regular
from cartwheel.description.files.source_folders import source_folders
from cartwheel.errors import Diagnostic, Origin

_LEVELS = 4
"""Number of folders above a file that may be its package."""
_PARTS = (
    "launch",
    "urdf",
    "xacro",
    "description",
    "meshes",
    "config",
    "models",
    "worlds",
    "robots",
)
"""Folders in a package."""
_ENDS = (".launch", ".xml", ".py", ".xacro", ".urdf", ".sdf", ".world")
"""Ends of the names of files that refer to packages."""
_MOST_FILES = 300
"""Maximum number of files that are read."""
_MOST_FOLDERS = 1000
"""Maximum number of folders that are searched for them."""
_MOST_BYTES = 500_000
"""Files that are larger are not read."""
_REFERENCE = re.compile(
    r"(?:\$\(find(?:-pkg-share)?\s{1,9}|package://)([\w-]++)\s{0,9}\)?/([\w./+-]++)(?!\$)"
)
"""A file in a package. Those with an unknown part do not count."""
_PROJECT = re.compile(r"^[ \t]*project\s*\(\s*\"?([\w-]+)", re.IGNORECASE | re.MULTILINE)
_SETUP = re.compile(r"\b(?:package_name|name)\s*=\s*[\"']([\w-]+)[\"']")
_OF_ROS = frozenset({"gazebo_ros", "ros_gz_sim", "ros_ign_gazebo", "ros_gz", "xacro"})
"""Packages whose files are often copied."""


def nameless_packages(file: Path) -> dict[str, Path]:
    """The folders above a file that stand for packages, by the names of the packages.

    Args:
        file: A file that is in no package.
    """
    found: dict[str, Path] = {}
    if package_above(file.parent) is not None:
        return found
    for folder in itertools.islice(file.parents, _LEVELS):
        if is_common(folder):
            break
        if any((folder / part).is_dir() for part in _PARTS) and not any(packages_in(folder)):
            for name in _names(folder):
                found.setdefault(name, folder)
    return {name: folder for name, folder in found.items() if name not in _OF_ROS}


def _names(folder: Path) -> Iterator[str]:
    """The names by which a folder is meant."""
    for file, pattern in (("CMakeLists.txt", _PROJECT), ("setup.py", _SETUP)):
        if (stated := pattern.search(text_if_regular(folder / file, _MOST_BYTES))) is not None:
            yield stated[1]
    stated_files: dict[str, set[str]] = {}
    for path in itertools.islice(_texts(folder), _MOST_FILES):
        for name, rest in _REFERENCE.findall(text_if_regular(path, _MOST_BYTES)):
            if ".." not in rest and not rest.endswith("/"):
                stated_files.setdefault(name, set()).add(rest)
    for name, files in stated_files.items():
        existing = sum(is_file(folder / rest) for rest in files)
        if 2 * existing > len(files):
            yield name


def _texts(folder: Path) -> Iterator[Path]:
    """The files in a folder and its subfolders that may refer to packages."""
    for here, names in itertools.islice(source_folders(folder), _MOST_FOLDERS):
        yield from (here / name for name in names if name.endswith(_ENDS))


def about_packages(
    neighbours: Mapping[str, Path],
    nameless: Mapping[str, Path],
    origins: Mapping[str, Origin | None],
) -> Iterator[Diagnostic]:
    """Reports packages that are in another repository, or have no package.xml.

    Args:
        neighbours: Packages of other repositories, by name.
        nameless: Folders that stand for packages, by the names of these.
        origins: The first elements that refer to them.
    """
    for name, folder in neighbours.items():
        yield PACKAGE_OF_NEIGHBOUR.diagnostic(
            f'the package "{name}" is not in the repository of the robot, so "{folder}" is used',
            origin=origins.get(name),
            hint="To use another one, add its folder to the package path.",
            values={"name": name, "used": str(folder)},
        )
    for name, folder in nameless.items():
        if name not in origins:
            continue  # a folder in a path of another computer
        yield PACKAGE_WITHOUT_MANIFEST.diagnostic(
            f'no package.xml contains the name "{name}", so ROS does not find the package; '
            f'"{folder}" is used',
            origin=origins.get(name),
            hint=f"Add a package.xml with <name>{name}</name> to the folder.",
            values={"name": name, "used": str(folder)},
        )
