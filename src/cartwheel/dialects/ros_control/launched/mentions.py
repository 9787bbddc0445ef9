"""Controllers that something else than a launch file starts: scripts, programs, or the user."""

from __future__ import annotations

import contextlib
import itertools
import re
from collections.abc import Collection, Iterator
from pathlib import Path

from cartwheel.description.files.regular_files import read_start
from cartwheel.description.files.repositories import repository_of
from cartwheel.description.files.source_folders import source_folders
from cartwheel.description.launches import root_of

_TEXTS = (".md", ".rst", ".txt", ".sh", ".bash", ".py", ".cpp", ".cc", ".hpp", ".h")
"""Ends of the names of programs and instructions."""
_LAUNCHES = (".launch.py", "_launch.py")
_LAUNCH_FOLDERS = frozenset({"launch", "launches"})
_MOST = 2000
"""Maximum number of folders that are searched, and of files that are read."""
_LONGEST = 200_000
"""Number of bytes that are read of each."""
_MOST_BYTES = 20_000_000
"""Number of bytes that are read of all."""
_STARTING = (
    *("spawner", "controller_manager", "set_controller_state", "start_controllers"),
    *(f"{verb}_controller" for verb in ("load", "switch", "configure", "activate")),
)
"""Parts of texts that start controllers."""
_WORD = re.compile(r"\w++")


def started_by_others(robot: Path, names: Collection[str]) -> frozenset[str]:
    """Returns those of the controllers' names that occur in programs or instructions which start
    controllers, in the repository of a robot or near it.

    Args:
        robot: The file of the robot.
        names: Names of controllers.
    """
    folder = repository_of(robot) or root_of(robot)
    if folder is None or not names:
        return frozenset()
    left, found = set(names), set[str]()
    for text in _texts(folder):
        if not left:
            break
        if any(part in text for part in _STARTING):
            words = set(_WORD.findall(text))
            held = {name for name in left if name.rpartition("/")[2] in words}
            found |= held
            left -= held
    return frozenset(found)


def _texts(folder: Path) -> Iterator[str]:
    """The programs and instructions in a folder."""
    paths = (
        here / name
        for here, names in itertools.islice(source_folders(folder), _MOST)
        for name in names
        if name.endswith(_TEXTS)
        and not name.endswith(_LAUNCHES)
        and here.name not in _LAUNCH_FOLDERS
    )
    left = _MOST_BYTES
    for path in itertools.islice(paths, _MOST):
        with contextlib.suppress(OSError):
            content = read_start(path, min(left, _LONGEST))
            left -= len(content)
            yield content.decode("utf-8", "replace")
        if not left:
            return
