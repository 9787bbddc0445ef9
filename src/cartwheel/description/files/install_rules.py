"""Finds files of an unbuilt package at the locations where its CMakeLists.txt installs them.

``$(find pkg)`` and ``package://pkg`` refer to the installed package. Many ROS 2 packages install
folders at different locations: ``description/urdf`` becomes ``share/pkg/urdf``.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from cartwheel.description.files.regular_files import read_regular_text

_COMMENT = re.compile(r"#[^\n]*")
_INSTALL = re.compile(r"\binstall\s*\(\s*DIRECTORY\s([^()]*)\)", re.IGNORECASE)
_PROJECT = re.compile(r"\bproject\s*\(\s*([^\s()]+)", re.IGNORECASE)
_MAX_LEVELS = 12
_OPTIONS = frozenset({
    "FILES_MATCHING", "PATTERN", "REGEX", "USE_SOURCE_PERMISSIONS", "OPTIONAL", "COMPONENT",
    "PERMISSIONS", "FILE_PERMISSIONS", "DIRECTORY_PERMISSIONS", "CONFIGURATIONS",
})  # fmt: skip


def source_of(path: Path) -> Path:
    """The source file that is installed as `path`; `path` itself if it exists or has no source.

    Args:
        path: A path, possibly below a package folder.
    """
    if path.exists():
        return path
    package = next(
        (p for p in list(path.parents)[:_MAX_LEVELS] if (p / "package.xml").is_file()), None
    )
    if package is None:
        return path
    inside = path.relative_to(package)
    for source, target in _installed(package / "CMakeLists.txt"):
        if inside.is_relative_to(target):
            found = package / source / inside.relative_to(target)
            if found.exists():
                return found
    return path


def _installed(lists: Path) -> Iterator[tuple[Path, Path]]:
    """Pairs of source folders and the corresponding folders in the installed package's share."""
    try:
        text = _COMMENT.sub("", read_regular_text(lists))
    except OSError:
        return
    project = _PROJECT.search(text)
    name = project[1].strip('"') if project is not None else lists.parent.name
    for found in _INSTALL.finditer(text):
        words = [word.strip('"') for word in found[1].split()]
        if "DESTINATION" not in words[:-1]:
            continue
        at = words.index("DESTINATION")
        share = words[at + 1].replace("${PROJECT_NAME}", name)
        root = Path("share") / name
        target = Path(share.replace("${CATKIN_PACKAGE_SHARE_DESTINATION}", str(root)))
        if not target.is_relative_to(root):
            continue
        target = target.relative_to(root)
        for word in words[:at]:
            if word in _OPTIONS:
                break
            folder = Path(word.replace("${CMAKE_CURRENT_SOURCE_DIR}/", ""))
            # With a trailing slash, the folder's contents are installed without the folder.
            yield folder, target if word.endswith("/") else target / folder.name
