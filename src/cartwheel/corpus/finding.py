"""Finds the robots in a folder: files that a user would load, without included files."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Sequence
from pathlib import Path

from cartwheel.description.files.named_files import find_description
from cartwheel.description.files.regular_files import read_regular_text
from cartwheel.description.loading import open_description, understand
from cartwheel.errors import DescriptionError

_SUFFIXES = (".xacro", ".urdf", ".sdf")
_SEMANTICS = (".srdf", ".srdf.xacro")
"""MoveIt's files, which begin like a robot."""
_SKIPPED = frozenset({"build", "devel", "install", "log", "node_modules", "__pycache__", "worlds"})
_COMMENT = re.compile(r"<!--.*?(?:-->|\Z)", re.DOTALL)
_ROOT = re.compile(r"<(robot|sdf|gazebo)\b")
_INCLUDE = re.compile(
    r"""<(?:xacro:)?include\b[^>]*?\bfilename\s*=\s*["']([^"']+)["']""", re.DOTALL
)
_FIND = re.compile(r"\$\(find(?:-pkg-share)?\s+([^\s()]+)\s*\)")
_VARIABLE = re.compile(r"\$\{[^}]*\}|\$\([^)]*\)")


def robots_in(folder: Path, *, package_path: Sequence[Path] = ()) -> list[Path]:
    """The complete robot descriptions in a folder and its subfolders, sorted by path.

    Worlds, macro-only files and parts are omitted. Parts are files that another description in the
    folder includes and that are not complete robots without it. Other unreadable files are kept, so
    that the test reports the error.

    Args:
        folder: A folder, or a single description.
        package_path: Additional folders to search for packages.
    """
    if folder.is_file():
        return [folder]
    texts = {path: text for path in _files(folder) if (text := _text(path)) is not None}
    names = {name for text in texts.values() for name in _INCLUDE.findall(text)}
    included = [pattern for name in names if (pattern := _pattern(name)) is not None]
    return [
        path
        for path in texts
        if _is_robot(path, package_path, part=any(one.search(path.as_posix()) for one in included))
    ]


def _files(folder: Path) -> Iterator[Path]:
    for root, folders, names in os.walk(folder):
        folders[:] = sorted(
            name for name in folders if not name.startswith(".") and name not in _SKIPPED
        )
        for name in sorted(names):
            if name.endswith(_SUFFIXES) and not name.endswith(_SEMANTICS):
                yield Path(root, name)


def _text(path: Path) -> str | None:
    """A description's text without comments; None for any other file."""
    try:
        text = _COMMENT.sub("", read_regular_text(path))
    except OSError:
        return None
    return text if _ROOT.search(text) else None


def _pattern(name: str) -> re.Pattern[str] | None:
    """A pattern for the end of an included file's path; None if nothing of the path is known."""
    known = _VARIABLE.sub("*", _FIND.sub(r"\1", name.strip()))
    known = known.removeprefix("file://").removeprefix("package://").lstrip("./")
    parts = [re.escape(part).replace(r"\*", "[^/]*") for part in known.split("/") if part]
    if not re.search(r"\w", known.removesuffix(".xacro").removesuffix(".urdf")):
        return None
    return re.compile("/" + "/".join(parts) + "$")


def _is_robot(path: Path, package_path: Sequence[Path], *, part: bool) -> bool:
    try:
        opened = open_description(path, {}, package_path)
        root = opened.root
        if root.tag != "robot":
            model = root.tag in ("sdf", "gazebo") and bool(root.all("model"))
            return model and _is_chosen(path)
        if not root.all("link"):
            return False
        if part:
            understand(opened)
    except DescriptionError:
        return not part and (path.suffix != ".sdf" or _is_chosen(path))
    return True


def _is_chosen(path: Path) -> bool:
    """Whether a model file is the one in its model.config, which may also list older versions."""
    if not (path.parent / "model.config").is_file():
        return True
    return path.samefile(find_description(path.parent))
