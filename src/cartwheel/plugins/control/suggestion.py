"""Which files could start the controllers of a robot of ros_control, which starts none itself."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from cartwheel.errors import CartwheelError
from cartwheel.plugins.control.files import is_ros2, read_parameters, ros1_entries

_LEVELS = 4
"""Folders above the robot's file that are looked through."""
_MOST = 400
"""Files that are looked at."""


def files_for(robot: Path, joints: Sequence[str]) -> list[Path]:
    """YAML files whose controllers name a robot's joints, or tell of all joints.

    Looked for below folders named ``config`` in the robot's package and those beside it.
    """
    found = []
    for path in _candidates(robot):
        try:
            content = read_parameters(path)
        except CartwheelError:
            continue
        if is_ros2(content):
            continue
        entries = ros1_entries(content, str(path))
        words = {word for entry in entries for word in _words(entry.values)}
        named = any(joint in word for joint in joints for word in words)
        broadcasts = len(entries) == 1 and "joint_state" in entries[0].type
        if named or broadcasts:
            found.append(path)
    return found


def _candidates(robot: Path) -> Iterator[Path]:
    package = next(
        (each for each in robot.resolve().parents[:_LEVELS] if (each / "package.xml").is_file()),
        None,
    )
    if package is None:
        return
    seen = 0
    for folder in sorted(package.parent.iterdir()):
        if not (folder / "package.xml").is_file():
            continue
        for path in sorted(folder.glob("**/config/**/*.y*ml")):
            seen += 1
            if seen > _MOST:
                return
            yield path


def _words(values: Any) -> Iterator[str]:
    if isinstance(values, str):
        yield values
    elif isinstance(values, Mapping):
        for key, value in values.items():
            yield str(key)
            yield from _words(value)
    elif isinstance(values, list):
        for value in values:
            yield from _words(value)
