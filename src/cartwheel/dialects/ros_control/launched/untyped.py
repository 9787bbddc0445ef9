"""Controllers of ROS 2 that a launch file starts although no file states their type."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from cartwheel.codes.devices import CONTROLLER_UNDEFINED
from cartwheel.description.elements.xml import shown_path
from cartwheel.description.launches import LaunchUse
from cartwheel.description.model import PluginTag, RobotDescription
from cartwheel.dialects.catalogue import short_name
from cartwheel.dialects.ros_control.files import moved_file, read_ros2, stated_path
from cartwheel.dialects.ros_control.launched.problems import undefined
from cartwheel.errors import Diagnostic, Origin, PluginError, Value

_DEEPEST = 8
"""Maximum nesting of the names of nodes."""


def unloadable(
    robot: RobotDescription, starter: LaunchUse | None, within: Path | None = None
) -> Iterator[Diagnostic]:
    """Controllers that a launch file starts, but that no file near it defines, or whose type no
    file states; see `undefined`.
    """
    lost: set[Value] = set()
    for each in undefined(robot, starter, within):
        lost.add(each.values["controller"])
        yield each
    yield from (each for each in _untyped(robot, starter) if each.values["controller"] not in lost)


def _untyped(robot: RobotDescription, starter: LaunchUse | None) -> Iterator[Diagnostic]:
    """Controllers that a launch file starts, but whose type is in none of the files that the robot
    and the launch file name. The controller manager does not load them.

    Nothing is known if one of these files cannot be read, or if there is another manager or robot.

    Args:
        robot: The robot, whose controller manager is of ROS 2.
        starter: The launch file.
    """
    tags = [tag for tag in robot.plugins if "ros2_control" in short_name(tag.filename)]
    if starter is None or not starter.spawned or len(tags) != 1:
        return
    if (
        starter.several
        or starter.managers
        or starter.absent
        or starter.unsure
        or starter.incomplete
    ):
        return
    files = _files(tags[0])
    if not files:
        return
    try:
        contents = [read_ros2(path, robot) for path in (*files, *starter.controllers)]
    except PluginError:
        return
    typed = frozenset[str]().union(*(_typed(each, 0) for each in contents), starter.typed)
    listed = ", ".join(f'"{path.name}"' for path in files)
    for name in starter.spawned:
        if name.rpartition("/")[2] not in typed:
            yield CONTROLLER_UNDEFINED.diagnostic(
                f'"{starter.file.name}" starts the controller "{name}", but {listed} does not '
                "state its type, so it cannot be loaded",
                origin=Origin(file=shown_path(files[0])),
                values={"controller": name, "untyped": True},
                hint="Below controller_manager and ros__parameters, add its name with a type.",
            )


def _files(tag: PluginTag) -> list[Path]:
    """The files that a plugin names; empty if one of them does not exist."""
    found: list[Path] = []
    for each in tag.element.find_all("parameters"):
        path = stated_path(each.text, tag.origin)
        if not path.is_file():
            moved, _ = moved_file(each.text, tag.origin)
            if moved is None:
                return []
            path = moved
        found.append(path)
    return found


def _typed(content: Mapping[str, Any], depth: int) -> set[str]:
    """The names of all nodes and parameters with a type, in any namespace."""
    found: set[str] = set()
    for key, value in content.items() if depth < _DEEPEST else ():
        name = str(key).rpartition("/")[2]
        if isinstance(value, Mapping):
            inner = value.get("ros__parameters", value)
            own: Sequence[Any] = [value, inner if isinstance(inner, Mapping) else {}]
            if any(isinstance(each.get("type"), str) for each in own):
                found.add(name)
            found |= _typed(value, depth + 1)
        elif name.endswith(".type") and isinstance(value, str):
            found.add(name.removesuffix(".type"))
    return found
