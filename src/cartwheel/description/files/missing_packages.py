"""Finds all missing packages of a description at once.

xacro stops at the first missing package, so users would otherwise find them one by one.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import NamedTuple

from cartwheel.description.files.regular_files import read_regular_text

MAX_FILES = 300
"""Maximum number of files to examine; a description has a few dozen."""
_SHOWN = 8
_COMMENT = re.compile(r"<!--.*?(?:-->|\Z)", re.DOTALL)
_NAMED = re.compile(r"(?:\$\(find(?:-pkg-share)?\s+|package://)([A-Za-z]\w*)\)?(/[^\s\"'<>]*)?")
_INCLUDED = re.compile(r"""filename\s*=\s*["']([^"'$:]+\.xacro)["']""")


class Advice(NamedTuple):
    """What to do about a missing file, package or model."""

    meant: str
    """The likely name, or an empty string."""
    hint: str
    others: tuple[str, ...] = ()
    """Other missing packages."""


def also_missing(
    files: Iterable[Path], missing: str, find: Callable[[str], Path | None]
) -> tuple[str, ...]:
    """Other missing packages that these files, or xacro files included by them, refer to.

    Args:
        files: The files to start with.
        missing: The package known to be missing.
        find: Returns a package's folder, or None if it is missing.
    """
    waiting = list(dict.fromkeys(files))
    seen = set(waiting)
    names: dict[str, None] = {}
    while waiting and len(seen) <= MAX_FILES:
        file = waiting.pop(0)
        try:
            text = _COMMENT.sub("", read_regular_text(file))
        except OSError:
            continue
        included = [file.parent / path for path in _INCLUDED.findall(text)]
        for name, path in _NAMED.findall(text):
            if name == missing or name in names:
                continue
            folder = find(name)
            if folder is None:
                names[name] = None
            elif path.endswith((".xacro", ".gazebo", ".urdf")):
                included.append(folder / path.lstrip("/"))
        for other in included:
            if other not in seen and other.is_file():
                seen.add(other)
                waiting.append(other)
    return tuple(names)


def advice(
    package: str, others: Iterable[str] = (), environment: Mapping[str, str] | None = None
) -> str:
    """One or two sentences on how to install the packages."""
    distribution = (os.environ if environment is None else environment).get("ROS_DISTRO")
    rest = list(others)
    text = ""
    if rest:
        more = f" and {len(rest) - _SHOWN} more" if len(rest) > _SHOWN else ""
        text = f"Also missing: {', '.join(rest[:_SHOWN])}{more}. "
    names = [package, *rest[: _SHOWN - 1]]
    if distribution:
        debian = " ".join(f"ros-{distribution}-{name.replace('_', '-')}" for name in names)
        return f"{text}Run: sudo apt install {debian}. Or clone the sources into the workspace."
    which = "package" if not rest else "packages"
    return f"{text}Install the {which} with apt as ros-<distribution>-<name>, or clone the sources."
