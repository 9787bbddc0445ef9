"""The folders on the disk that contain packages, by the name in package.xml.

A package of rosbuild, the build system before catkin, contains only a manifest.xml and has the name
of its folder. Exporters of CAD programs still write this file.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from functools import cache, lru_cache
from itertools import chain
from pathlib import Path

from cartwheel.description.files.readable_files import is_common

MAX_ENTRIES = 500
"""A folder with more entries is not a workspace; only these are examined."""
MAX_CRAWLED = 20_000
"""Maximum number of folders to search below one root."""
MAX_LEVELS_UP = 5
"""Number of levels above a file or its package at which a workspace may begin."""
IGNORE_MARKERS = frozenset({"CATKIN_IGNORE", "COLCON_IGNORE", "AMENT_IGNORE"})
"""Files that exclude a folder from the search for packages."""
_SKIPPED = frozenset({"build", "devel", "log", "node_modules", "__pycache__", "proc", "sys", "dev"})
_NAME = re.compile(rb"<name>\s*([^<>\s]+)\s*</name>")
_PACKAGE = re.compile(rb"<package[\s/>]")
_COMMENT = re.compile(rb"<!--.*?(?:-->|\Z)", re.DOTALL)


@cache
def share() -> Path:
    """The folder with the built-in ``robots``, ``worlds``, ``models`` and ``standins``.

    The repository's root in a checkout, ``cartwheel/share`` in an installed package.
    """
    package = Path(__file__).resolve().parents[2]
    installed = package / "share"
    return installed if installed.is_dir() else package.parent.parent


def stand_ins() -> Path:
    """The folder with Cartwheel's own packages for sensor packages that are not installed."""
    return share() / "standins"


def is_in_stand_in(file: str) -> bool:
    """Whether a file is one of Cartwheel's own packages; False for an empty name."""
    return bool(file) and Path(file).absolute().is_relative_to(stand_ins())


def stand_in_name(path: Path) -> str | None:
    """The package that a file replaces; None unless the file is in a stand-in package."""
    root = stand_ins()
    if not path.is_relative_to(root):
        return None
    parts = path.relative_to(root).parts
    return parts[0] if len(parts) > 1 else None


def around(folder: Path) -> list[Path]:
    """The folder and those above it, nearest first, that may belong to its workspace."""
    parents = [folder, *folder.parents]
    levels = MAX_LEVELS_UP
    for index, parent in enumerate(parents):
        if package_name(parent) is not None:
            levels = max(levels, index + MAX_LEVELS_UP)
    chosen = []
    for parent in parents[:levels]:
        # Shared folders are slow to read, and folders for temporary files contain anyone's
        # files.
        if is_common(parent):
            break
        chosen.append(parent)
    return chosen or parents[:1]


def package_above(folder: Path) -> Path | None:
    """The package that contains a folder."""
    near = [folder, *folder.parents][:MAX_LEVELS_UP]
    return next((each for each in near if package_name(each) is not None), None)


class PackagesByName:
    """Packages by name. Each folder is looked at once, and only if its package may be meant.

    Args:
        packages: Names and folders of packages, nearest first.
    """

    def __init__(self, packages: Iterator[tuple[str, Path]]) -> None:
        self._left = packages
        self._folders: dict[str, list[Path]] = {}

    def first(self, name: str) -> Path | None:
        """The nearest package with a name; None if there is none."""
        while name not in self._folders and self._look():
            pass
        return next(iter(self._folders.get(name, ())), None)

    def all(self, name: str) -> list[Path]:
        """All packages with a name, nearest first."""
        while self._look():
            pass
        return self._folders.get(name, [])

    def _look(self) -> bool:
        """Looks at the next package; returns whether there was one."""
        for name, folder in self._left:
            self._folders.setdefault(name, []).append(folder)
            return True
        return False


def packages_in(root: Path) -> Iterator[tuple[str, Path]]:
    """Names and folders of the packages of the workspace at `root`, nearest first."""
    for folder in chain((root,), _nested(root)):
        name = package_name(folder)
        if name is not None:
            yield name, folder


def packages_below(root: Path) -> Iterator[tuple[str, Path]]:
    """Those at any depth below `root`; packages do not contain other packages."""
    level = [root]
    looked = 0
    while level and looked < MAX_CRAWLED:
        below = []
        for folder in level:
            for each in folders_in(folder):
                looked += 1
                name = package_name(each)
                if name is None:
                    below.append(each)
                else:
                    yield name, each
        level = below


def _nested(root: Path) -> Iterator[Path]:
    """The folders in which a package of the workspace at `root` may be, nearest first."""
    first = list(folders_in(root))
    yield from first
    for folder in first:
        if package_name(folder) is not None:
            continue
        second = list(folders_in(folder))
        yield from second
        if folder.name in ("src", "install", "share"):
            for inner in second:
                if package_name(inner) is None:
                    yield from folders_in(inner)
                    yield from folders_in(inner / "share")


def belongs_to(path: Path, home: Path) -> bool:
    """Whether a file is in the folder of a package or model, after resolving links.

    Links in an installed package may lead to its source, which has the same name.
    """
    real, home = path.resolve(), home.resolve()
    if real.is_relative_to(home):
        return True
    source = next((each for each in real.parents if package_name(each) is not None), None)
    return source is not None and package_name(source) == package_name(home)


def package_name(folder: Path) -> str | None:
    """The name in the folder's package.xml, or the folder's name if it contains only a manifest.xml
    of a package; otherwise None.
    """
    # Each search looks at many folders, and paths as texts take a third of the time.
    for manifest in (f"{folder}/package.xml", f"{folder}/manifest.xml"):
        try:
            changed = os.stat(manifest).st_mtime_ns  # noqa: PTH116
        except (OSError, ValueError):
            continue
        found = _declared_name(manifest, changed)
        if found is not None:
            return found
    return None


@lru_cache(maxsize=4096)
def _declared_name(path: str, _changed: int) -> str | None:
    manifest = Path(path)
    if not is_file(manifest):
        return None
    try:
        with manifest.open("rb") as file:
            text = _COMMENT.sub(b"", file.read(16384))
    except OSError:
        return None
    if manifest.name == "manifest.xml":
        # Files of other programs have the same name.
        return manifest.parent.name if _PACKAGE.search(text) else None
    match = _NAME.search(text)
    return match[1].decode("utf-8", "replace") if match else manifest.parent.name


def folders_in(folder: Path) -> tuple[Path, ...]:
    """The subfolders, except those that cannot contain packages."""
    try:
        changed = folder.stat().st_mtime_ns
    except (OSError, ValueError):
        return ()
    return _listing(folder, changed)


@lru_cache(maxsize=4096)
def _listing(folder: Path, _changed: int) -> tuple[Path, ...]:
    names = []
    try:
        with os.scandir(folder) as entries:
            for count, entry in enumerate(entries):
                if count >= MAX_ENTRIES:
                    break
                if entry.name in IGNORE_MARKERS:
                    return ()
                hidden = entry.name.startswith(".") or entry.name in _SKIPPED
                if not hidden and entry.is_dir():
                    names.append(entry.name)
    except OSError:
        return ()
    return tuple(folder / name for name in sorted(names))


def is_file(path: Path) -> bool:
    """Whether a file exists; False for paths that cannot exist or may not be read."""
    try:
        return path.is_file()
    except (OSError, ValueError):
        return False


def is_dir(path: Path) -> bool:
    """Whether a folder exists; False for paths that cannot exist or may not be read."""
    try:
        return path.is_dir()
    except (OSError, ValueError):
        return False
