"""Where a file may be that is not where a description says."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

from cartwheel.description.files.package_folders import package_above, package_name

FIND = re.compile(r"\$\(find(?:-pkg-share)?\s+([^\s()]+)\s*\)")
"""A package's folder in xacro and in launch files."""
_DEEPEST = 8
"""Number of folders in the path of a missing file that may be packages."""


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
