"""Where a file may be that is not where a description says."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from cartwheel.codes.files import FILE_ELSEWHERE
from cartwheel.description.files.package_folders import package_above, package_name
from cartwheel.errors import Diagnostic, Origin, Value

FIND = re.compile(r"\$\(find(?:-pkg-share)?\s+([^\s()]+)\s*\)")
"""A package's folder in xacro and in launch files."""
_PACKAGE = re.compile(r"package://([^/]+)/")
_DEEPEST = 8
"""Number of folders in the path of a missing file that may be packages."""
_HOME = re.compile(r"(?:file://)?/(?:home|Users)/[^/]+/")
"""The beginning of a path in a home folder. That of root is often a folder of a container, which
has the file."""

Use = Literal["", "collision", "controllers", "include", "model"]
"""What a simulation lacks without a file; empty if it only looks different."""
_LOST: dict[Use, str] = {
    "collision": "Gazebo leaves out the collision",
    "controllers": "no controller starts",
    "include": "xacro stops",
    "model": "Gazebo leaves out the model",
}


@dataclass(frozen=True, slots=True)
class Moved:
    """A file that is not where a description says."""

    path: Path
    """The file that is used."""
    origin: Origin | None
    """The first element that refers to it, or one for which it matters."""
    use: Use
    lacking: str = ""
    """The package in which it is stated to be, if that was not found."""


def other_places(
    uri: str, folders: Iterable[Path], package: Callable[[str], Path | None]
) -> Iterator[Path]:
    """The places in which a missing file may be, likeliest first.

    In ``/home/me/ws/src/my_robot/meshes/base.stl``, ``my_robot`` may be a package that is found on
    this computer. A relative path may start in a folder above the description's, from which the
    author runs xacro. In ``package://my_robot/meshes/base.stl`` and
    ``$(find my_robot)/meshes/base.stl``, with or without ``file://``, ``my_robot`` may be a former
    name of the description's own package.

    Args:
        uri: The statement in the description.
        folders: The description's folder and those above it in its workspace.
        package: Returns the folder of a package.
    """
    bare = uri.removeprefix("file://")
    uri = FIND.sub(r"package://\1", bare, count=1) if bare.startswith("$(") else uri
    scheme, separator, rest = uri.partition("://")
    if ".." in Path(uri).parts:
        return
    if not separator or scheme == "package":
        given = Path(rest.partition("/")[2] if separator else uri)
        if given.parts and not given.is_absolute():
            yield from (folder / given for folder in folders)
            return
    elif scheme != "file":
        return
    given = Path(uri.removeprefix("file://"))
    parts = given.parts[1:]
    for index in range(len(parts) - 2, max(-1, len(parts) - 2 - _DEEPEST), -1):
        found = package(parts[index]) if given.is_absolute() else None
        if found is not None:
            yield found.joinpath(*parts[index + 1 :])


def lacks(uri: str, package: Callable[[str], Path | None]) -> str:
    """The package in which a file is stated to be if it is not found; otherwise an empty text."""
    stated = FIND.search(uri) or _PACKAGE.match(uri)
    return stated[1] if stated and package(stated[1]) is None else ""


def how_to_refer_to(path: Path) -> str:
    """A sentence with the reference to write for a file that exists."""
    folder = package_above(path.parent)
    if folder is None:
        return "Write a path relative to this file."
    name, file = package_name(folder), path.relative_to(folder)
    return (
        f"Write package://{name}/{file}, or $(find {name})/{file} in xacro, or a path relative to "
        "this file."
    )


def is_in_home(uri: str) -> bool:
    """Whether an absolute path, or the URI of a file, is in a home folder."""
    return _HOME.match(uri) is not None


def report(uri: str, moved: Moved) -> Diagnostic:
    """Reports a file that is not where a description says.

    It is an error if no other computer than the author's has the file, and it matters, or if xacro
    stops. Its value ``needed_for`` then contains its use. If a package was not found, it is a
    warning, because the package may be installed elsewhere, and the value ``unfound`` is its name.
    """
    lacking = moved.lacking
    stops = f'Without the package "{lacking}", ROS stops here. ' if lacking else ""
    at_home = is_in_home(uri)
    lost = moved.use if at_home or (moved.use == "include" and not lacking) else ""
    found: dict[str, Value] = {"needed_for": lost} if lost else {}
    if lacking and moved.use == "include":
        found = {"needed_for": moved.use, "unfound": lacking}
    message = f'"{uri}" does not exist, so "{moved.path}" is used'
    if lacking:
        message = f'the package "{lacking}" was not found, so "{moved.path}" is used for "{uri}"'
    elif lost:
        where = "is in a home folder" if at_home else "does not exist"
        message = (
            f'"{uri}" {where}, so {_LOST[lost]}{" on other computers" * at_home}; here, '
            f'"{moved.path}" is used'
        )
    return FILE_ELSEWHERE.diagnostic(
        message,
        origin=moved.origin,
        hint=f"{stops}{how_to_refer_to(moved.path)}",
        severity="error" if lost else "warning",
        values={"name": uri, "used": str(moved.path), **found},
    )
