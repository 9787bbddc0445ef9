"""Finds the robots, models and worlds in a folder, without files that are only included."""

from __future__ import annotations

import os
import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from cartwheel.checks import nodes
from cartwheel.description.elements import xml
from cartwheel.description.elements.node import Node
from cartwheel.description.files.package_folders import IGNORE_MARKERS
from cartwheel.description.files.source_folders import source_folders

SUFFIXES = (".xacro", ".urdf", ".sdf", ".world")
MOST = 5000
"""Maximum number of files to examine in a folder."""
_SUBSTITUTION = re.compile(r"\$\{[^}]*\}|\$\([^)]*\)|^(?:package|model|file)://")
_FIND = re.compile(r"^(?:\$\(find(?:-pkg-share)? +([\w.-]+)\)|package://([\w.-]+))/(.+)$")
_BUILT_IN = frozenset({
    "include", "arg", "property", "macro", "if", "unless", "insert_block", "call", "element",
    "attribute",
})  # fmt: skip
Walked = Sequence[tuple[Path, list[str]]]
"""Folders, and the names of their files."""


def descriptions(folder: Path) -> list[Path]:
    """The top-level descriptions below a folder, sorted by path.

    Build folders, hidden folders and folders with ``COLCON_IGNORE`` or similar files are skipped.
    Unreadable files are included, so that their errors are reported.
    """
    walked = list(source_folders(folder, markers=IGNORE_MARKERS))
    files = {path: _File.read(path) for path in _files(walked)}
    included: set[Path] = set()
    packages = {path.parent.name: path.parent for path in _manifests(folder, walked)}
    for path, file in files.items():
        included |= set(_included(path, file.includes, packages, files)) - {path}
    return [path for path, file in files.items() if path not in included and file.describes]


@dataclass(frozen=True, slots=True)
class _File:
    """The relevant facts about a file: keeping thousands of trees would need too much memory."""

    includes: tuple[str, ...]
    """Included file names, as written."""
    describes: bool
    """Whether the file describes something by itself, or cannot be read."""

    @classmethod
    def read(cls, path: Path) -> _File:
        root = xml.readable_file(path)
        if root is None:
            return cls((), describes=True)
        return cls(tuple(_includes(root)), describes=_describes(root))


def _files(walked: Walked) -> list[Path]:
    found = (here / name for here, names in walked for name in names if name.endswith(SUFFIXES))
    return [path for _, path in zip(range(MOST), found, strict=False) if path.is_file()]


def _manifests(folder: Path, walked: Walked) -> list[Path]:
    above = [each / "package.xml" for each in folder.absolute().parents]
    below = (here / "package.xml" for here, names in walked if "package.xml" in names)
    return [*(path for path in above if path.is_file()), *below]


def _includes(root: Node) -> Iterator[str]:
    for node in nodes.walk(root):
        name = node.attributes.get("filename", "")
        if node.tag in ("xacro:include", "include") and name:
            yield name


def _included(
    path: Path, names: Sequence[str], packages: Mapping[str, Path], known: Collection[Path]
) -> Iterator[Path]:
    for name in names:
        match = _FIND.match(name)
        if match is not None and "$" not in match[3]:
            package = packages.get(match[1] or match[2])
            if package is not None:
                yield package / match[3]
                continue
        if not _SUBSTITUTION.search(name):
            yield Path(os.path.normpath(path.parent / name))
            continue
        # An expression's value is unknown here: any file with the same ending may be included.
        tail = PurePosixPath(_SUBSTITUTION.split(name)[-1].lstrip("/")).parts
        if tail:
            yield from (each for each in known if each.parts[-len(tail) :] == tail)


def _describes(root: Node) -> bool:
    """Whether a file describes something by itself, instead of only defining macros."""
    if root.tag != "robot":
        tags = ("model", "world", "light")
        return root.tag in ("sdf", "gazebo") and any(each.tag in tags for each in root.children)
    return any(
        each.tag == "link"
        or (each.tag.startswith("xacro:") and each.tag.removeprefix("xacro:") not in _BUILT_IN)
        or each.tag in ("xacro:if", "xacro:unless", "xacro:call", "xacro:include")
        for each in root.children
    )
