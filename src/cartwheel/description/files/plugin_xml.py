"""Classes that a repository exports to pluginlib, by the XML files in its packages."""

from __future__ import annotations

import itertools
import re
from collections.abc import Collection, Mapping
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
    return next((path for path, _ in _found(file, (name,)).values()), None)


def base_classes(file: Path, names: Collection[str]) -> dict[str, str]:
    """The base classes that the repository of a file states where it exports classes.

    Args:
        file: Any file of the repository.
        names: The classes, such as ``my_driver/MyHardware``.

    Returns:
        A class, such as ``hardware_interface::SystemInterface``, for each name that the repository
        exports; empty if none is stated.
    """
    return {name: base for name, (_, base) in _found(file, names).items()}


def _found(file: Path, names: Collection[str]) -> dict[str, tuple[Path, str]]:
    """The XML files that export classes, and the base classes that they state, by name."""
    root = repository_of(file) if names else None
    found: dict[str, tuple[Path, str]] = {}
    if root is None:
        return found
    folders = itertools.chain([root], (folder for _, folder in packages_below(root)))
    missing = {name: name.strip().replace("::", "/") for name in names}
    for folder in itertools.islice(folders, _PACKAGES):
        for path in itertools.islice(sorted(folder.glob("*.xml")), _FILES):
            try:
                exported = _exported(path, path.stat().st_mtime_ns)
            except OSError:
                continue
            for name in [name for name, plain in missing.items() if plain in exported]:
                found[name] = path, exported[missing.pop(name)]
            if not missing:
                return found
    return found


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
