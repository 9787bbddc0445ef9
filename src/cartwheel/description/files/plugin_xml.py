"""Classes that a repository exports to pluginlib, by the XML files in its packages."""

from __future__ import annotations

import itertools
import re
from collections.abc import Mapping
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
_BASE = re.compile(r"""\bbase_class_type\s*=\s*["']([^"'<>]+)["']""")


def exporting_file(file: Path, name: str) -> Path | None:
    """The XML file in the repository of a file that exports a class.

    Args:
        file: Any file of the repository.
        name: The class, such as ``my_control/MyController``.

    Returns:
        None if no file exports it, or if the repository is unknown.
    """
    found = _found(file, name)
    return None if found is None else found[0]


def base_class(file: Path, name: str) -> str | None:
    """The base class that the repository of a file states where it exports a class.

    Args:
        file: Any file of the repository.
        name: The class, such as ``my_driver/MyHardware``.

    Returns:
        A class, such as ``hardware_interface::SystemInterface``; empty if none is stated. None if
        no file exports the class, or if the repository is unknown.
    """
    found = _found(file, name)
    return None if found is None else found[1]


def _found(file: Path, name: str) -> tuple[Path, str] | None:
    """The XML file that exports a class, and the base class that it states."""
    root = repository_of(file)
    if root is None:
        return None
    folders = itertools.chain([root], (folder for _, folder in packages_below(root)))
    plain = name.strip().replace("::", "/")
    for folder in itertools.islice(folders, _PACKAGES):
        for path in itertools.islice(sorted(folder.glob("*.xml")), _FILES):
            try:
                exported = _exported(path, path.stat().st_mtime_ns)
                if plain in exported:
                    return path, exported[plain]
            except OSError:
                continue
    return None


@lru_cache(maxsize=2 * _PACKAGES * _FILES)
def _exported(path: Path, _changed: int) -> Mapping[str, str]:
    """The names and types of the classes that a file exports, with slashes, and their base classes.

    A robot may have many controllers, each of which is searched.

    Raises:
        OSError: The file cannot be read.
    """
    text = read_start(path, _BYTES).decode("utf-8", "replace")
    tags = _TAG.finditer(_COMMENT.sub("", text))
    names = (
        (name.replace("::", "/"), base[1].strip() if base is not None else "")
        for tag in tags
        for base in (_BASE.search(tag[0]),)
        for name in _NAME.findall(tag[0])
    )
    return dict(itertools.islice(names, _NAMES))
