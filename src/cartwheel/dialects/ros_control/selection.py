"""The controllers that a robot's own package starts, by its launch files and YAML files."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from cartwheel.description.launches import (
    LaunchUse,
    chosen,
    controllers_for,
    launches_near,
    root_of,
)
from cartwheel.description.model import RobotDescription
from cartwheel.dialects.ros_control.files import for_robot, read_parameters
from cartwheel.dialects.ros_control.suggestion import commanding, suggested
from cartwheel.errors import PluginError


@dataclass(frozen=True, kw_only=True, slots=True)
class Selection:
    """Controller files, and the controllers in them that are started."""

    files: tuple[Path, ...]
    """YAML files with controllers for the robot."""
    names: tuple[str, ...]
    """Names of the controllers that the launch file starts; empty: all."""


def selection_near(robot: RobotDescription, package_path: Sequence[Path] = ()) -> Selection:
    """The controllers that the launch files in the robot's package start, or those near it.

    Empty if the robot has no controller manager, or if its tags name the files.

    Args:
        robot: The robot.
        package_path: Folders to search for packages first.
    """
    if not suggested(robot):
        return Selection(files=(), names=())
    file = Path(robot.origin.file)
    folder = root_of(file)
    launches = () if folder is None else launches_near(folder, package_path)
    return selection(robot, chosen(file, launches), launches)


def launched(robot: RobotDescription) -> tuple[str, ...]:
    """Names of the controllers that the launch files in the robot's package start."""
    file = Path(robot.origin.file)
    folder = root_of(file)
    launches = () if folder is None else launches_near(folder)
    use = chosen(file, launches)
    starter = use if use is not None and use.spawned else controllers_for(file, use, launches)
    return () if starter is None else starter.spawned


def selection(
    robot: RobotDescription, use: LaunchUse | None, launches: Sequence[LaunchUse]
) -> Selection:
    """As `selection_near`, with launch files that have been read.

    Files that need values from a launch file are left out.

    Args:
        robot: The robot.
        use: The launch file that starts the robot; None if there is none.
        launches: All launch files near the robot.
    """
    starter = controllers_for(Path(robot.origin.file), use, launches)
    named = suggested(robot, among=starter.controllers) if starter is not None else []
    if starter is not use and not commanding(robot, named):
        # The launch file of another part only publishes the states of all joints.
        starter, named = None, []
    files = tuple(each for each in named or suggested(robot) if _is_complete(each, robot))
    names = starter.spawned if starter is not None and (named or not files) else ()
    return Selection(files=files, names=names)


def _is_complete(path: Path, robot: RobotDescription) -> bool:
    """Whether a controller file contains no arguments that only a launch file could set."""
    try:
        for_robot(read_parameters(path), path, robot)
    except PluginError:
        return False
    return True
