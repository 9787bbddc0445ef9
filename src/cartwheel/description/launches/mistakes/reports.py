"""Reports launch files that do not start."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from pathlib import Path

from cartwheel.codes.files import LAUNCH_STOPS
from cartwheel.description.elements import numbers
from cartwheel.description.launches.launch_use import LaunchUse, MissingFile
from cartwheel.description.launches.mistakes.unexpanded import unexpanded
from cartwheel.errors import Diagnostic

_MOST_NAMES = 2000
"""Maximum number of files in a folder that are compared with a missing one."""


def stopping(use: LaunchUse | None) -> Iterator[Diagnostic]:
    """The missing files without which the launch file for a robot does not start it.

    Args:
        use: The launch file that was chosen for the robot. If others start it as well, it is only
            one with missing files if those have some too.
    """
    if use is None or not use.simulated or use.lacking:
        return
    known = {each.origin.line for each in use.unfound}
    for each in use.stopped:
        if each.what == "parameters" and each.origin.line in known:
            continue  # reported with the controllers that do not start
        yield LAUNCH_STOPS.diagnostic(
            f"{_subject(each)}, so {_effect(each)}",
            origin=each.origin,
            values={"file": each.name, "what": each.what},
            hint=_hint(each),
        )


def launch_mistakes(
    description: Path, use: LaunchUse | None, launches: Sequence[LaunchUse]
) -> tuple[Diagnostic, ...]:
    """Why a robot is not, or not completely, started by its launch files.

    Args:
        description: The description.
        use: The launch file that was chosen for it.
        launches: Launch files of its author.
    """
    return (*unexpanded(description, launches), *stopping(use))


def _subject(missing: MissingFile) -> str:
    what = {"world": "world", "gz world": "world", "launch file": "included launch file"}.get(
        missing.what, "file"
    )
    if missing.at_home:
        return f'the {what} "{missing.name}" is in a home folder'
    return f'the {what} "{missing.name}" does not exist'


def _effect(missing: MissingFile) -> str:
    where = " on other computers" if missing.at_home else ""
    if missing.what in ("world", "gz world"):
        return f"Gazebo does not start{where}"
    return f"ROS does not start the launch file{where}"


def _hint(missing: MissingFile) -> str:
    path = Path(missing.name)
    if missing.at_home:
        return "Add the file to a package, and write its path with the folder of the package."
    if not path.is_absolute():
        return (
            "Gazebo searches the current folder and GAZEBO_RESOURCE_PATH. Its own worlds have "
            'names such as "worlds/empty.world".'
        )
    try:
        names = [each.name for each in itertools.islice(path.parent.iterdir(), _MOST_NAMES)]
    except OSError:
        return ""
    near = numbers.likely(path.name, names)
    return f'Did you mean "{near}"?' if near else ""
