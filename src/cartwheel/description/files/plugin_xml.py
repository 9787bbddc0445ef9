"""Classes that a repository exports to pluginlib, by the XML files in its packages."""

from __future__ import annotations

import itertools
import re
from functools import lru_cache
from pathlib import Path

from cartwheel.description.files.package_folders import packages_below
from cartwheel.description.files.regular_files import read_start
from cartwheel.description.files.repositories import repository_of

_PACKAGES, _FILES, _BYTES = 200, 20, 65536
"""Packages of a repository that are searched, XML files of each, and bytes of each file."""
_NAMES = 300
"""Names and types of each file that are kept."""
_COMMENT = re.compile(r"<!--.*?(?:-->|\Z)", re.DOTALL)
_TAG = re.compile(r"<class\s[^<>]*>")
_NAME = re.compile(r"""\b(?:name|type)\s*=\s*["']([^"'<>]+)["']""")


def exporting_file(file: Path, name: str) -> Path | None:
    """The XML file in the repository of a file that exports a class.

    Args:
        file: Any file of the repository.
        name: The class, such as ``my_control/MyController``.

    Returns:
        None if no file exports it, or if the repository is unknown.
    """
    root = repository_of(file)
    if root is None:
        return None
    folders = itertools.chain([root], (folder for _, folder in packages_below(root)))
    plain = name.strip().replace("::", "/")
    for folder in itertools.islice(folders, _PACKAGES):
        for path in itertools.islice(sorted(folder.glob("*.xml")), _FILES):
            try:
                if plain in _exported(path, path.stat().st_mtime_ns):
                    return path
            except OSError:
                continue
    return None


@lru_cache(maxsize=2 * _PACKAGES * _FILES)
def _exported(path: Path, _changed: int) -> frozenset[str]:
    """The names and types of the classes that a file exports, with slashes.

    A robot may have many controllers, each of which is searched.

    Raises:
        OSError: The file cannot be read.
    """
    text = read_start(path, _BYTES).decode("utf-8", "replace")
    tags = _TAG.finditer(_COMMENT.sub("", text))
    names = (each.replace("::", "/") for tag in tags for each in _NAME.findall(tag[0]))
    return frozenset(itertools.islice(names, _NAMES))
