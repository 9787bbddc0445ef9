"""Finds the launch files near a robot, and chooses the one whose settings are used."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from cartwheel.description.files.package_search import Searched
from cartwheel.description.files.packages import Packages
from cartwheel.description.files.source_folders import source_folders
from cartwheel.description.launches.alternatives import left_out, uses_with_others
from cartwheel.description.launches.effort import Effort, TooCostlyError
from cartwheel.description.launches.launch_use import LaunchUse

_FOLDER = 100
"""Steps to list a folder."""
_MOST = 500
"""Maximum number of launch files in a folder."""
_PUBLISHER = re.compile(r"state|broad", re.IGNORECASE)
"""Part of the names of controllers that only publish, such as ``joint_state_controller``."""


def launches_near(folder: Path, package_path: Sequence[Path] = ()) -> tuple[LaunchUse, ...]:
    """The robots that the launch files in a folder and its subfolders start, sorted by path.

    A launch file that starts controllers for a robot of another launch file is one of them, without
    a description. Launch files are parsed, not executed. Texts that cannot be determined without
    executing them are left out. What costs too much to read is left out too, and reported in
    `left_out` of the launch file or folder.
    """
    found: list[LaunchUse] = []
    # Which package is found depends on the folder of the launch file.
    packages: dict[Path, Packages] = {}
    searched: Searched = {}
    effort = Effort()
    last = "none of them is"
    try:
        for number, path in enumerate(launch_files(folder, effort)):
            if number == _MOST:
                found.append(left_out(folder, f"there are more than {_MOST} launch files", last))
                break
            near = packages.get(path.parent) or Packages(path, package_path, searched=searched)
            packages[path.parent] = near
            found += _read_apart(path, near, effort)
            last = f'only those up to "{path.relative_to(folder)}" are'
    except TooCostlyError:
        found.append(left_out(folder, "reading all launch files takes too long", last))
    return tuple(found)


def _read_apart(path: Path, packages: Packages, effort: Effort) -> Iterator[LaunchUse]:
    """What a launch file starts, as far as it can be read with a part of the effort."""
    with effort.portion():
        yield from uses_with_others(path, packages, effort)
        return
    yield left_out(path, "reading the launch file takes too long", "not all of it is")


def chosen(description: Path, uses: Iterable[LaunchUse]) -> LaunchUse | None:
    """The launch file for a description: one that starts Gazebo and controllers, if there is one.

    One that starts Gazebo with its default arguments, and more than the publisher of joint states,
    comes first, unless a file that it needs is missing. Among equal ones it is the first by the
    number of unknown arguments and by path.
    """
    path = description.resolve()
    own = [
        each for each in uses if each.description is not None and each.description.resolve() == path
    ]
    return min(own, key=_order, default=None)


def controllers_for(
    description: Path, use: LaunchUse | None, uses: Sequence[LaunchUse]
) -> LaunchUse | None:
    """The launch file that starts a description's controllers: its own, or another one without a
    description in the same package, or in a package beside it.
    """
    if use is not None and use.controllers:
        return use
    return next(iter(starters(description, uses)), None)


def starters(
    description: Path, uses: Sequence[LaunchUse], *, described: bool = False
) -> list[LaunchUse]:
    """The launch files without a description that start controllers, nearest first.

    Args:
        description: The description.
        uses: Contents of launch files.
        described: Whether those with this description follow, which load it once more.
    """
    kinds: tuple[Path | None, ...] = (None, description.resolve()) if described else (None,)
    others = [
        (kinds.index(own), each)
        for each in uses
        if (own := each.description and each.description.resolve()) in kinds
        and each.spawned
        and each.controllers
    ]
    home = description.absolute()
    others.sort(
        key=lambda one: (
            one[0],
            # Another one may be for the real robot.
            one[0] > 0 and not one[1].simulated,
            -shared_parts(one[1].file, home),
            str(one[1].file),
        )
    )
    return [each for _, each in others]


def _order(use: LaunchUse) -> tuple[bool, bool, bool, bool, int, bool, int, int, str]:
    return (
        not use.simulated,
        bool(use.stopped),
        bool(use.switched),
        # Another launch file may include it and state the argument.
        use.lacking,
        # A file may be loaded without a controller in it being started.
        -bool(use.spawned) - bool(use.controllers),
        # Launch files of MoveIt's assistant may only start a controller that moves nothing.
        not any(map(moves, use.spawned)),
        use.unknown,
        len(use.file.parts),
        str(use.file),
    )


def moves(name: str) -> bool:
    """Whether a controller may move joints, by its name: it is no publisher."""
    return _PUBLISHER.search(name) is None


def shared_parts(one: Path, other: Path) -> int:
    """How near two files are: the number of folders that contain both."""
    return len(Path(os.path.commonpath([one.absolute(), other.absolute()])).parts)


def launch_files(folder: Path, effort: Effort) -> Iterator[Path]:
    """The launch files in a folder and its subfolders, sorted by path."""
    for here, names in source_folders(folder):
        effort.spend(_FOLDER + len(names))
        yield from (here / name for name in names if _is_launch(here / name))


def _is_launch(path: Path) -> bool:
    """Whether a file is a launch file by its name, or by its folder, such as ``launch/sim.py``."""
    if path.name.endswith((".launch", ".launch.xml", ".launch.py", "_launch.py")):
        return True
    return path.suffix in (".py", ".xml") and path.parent.name == "launch"
