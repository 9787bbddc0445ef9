"""Finds the controller files of a robot: files it refers to, or files a launch file may load."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import cache, partial
from pathlib import Path

from cartwheel.checks.controller_files import ControlFile
from cartwheel.checks.robot import Robot
from cartwheel.codes import devices as devices_codes
from cartwheel.description.files.package_folders import package_name
from cartwheel.description.files.packages import Packages
from cartwheel.description.files.repositories import repository_of
from cartwheel.description.launches import (
    LaunchUse,
    chosen,
    launches_near,
    own_folder,
    own_launches,
    root_of,
)
from cartwheel.description.model import Element
from cartwheel.dialects.ros_control.selection import Selection, selection
from cartwheel.dialects.ros_control.suggestion import files_for, is_controlled
from cartwheel.errors import DescriptionError, Diagnostic


def controller_files_of(
    robots: Sequence[Robot],
    packages: Packages,
    given: Sequence[Path],
) -> tuple[list[tuple[Robot, ControlFile]], list[Diagnostic]]:
    """The controller files of each robot, and the mistakes in launch files that start controllers.

    Args:
        robots: Robots in the description.
        packages: Resolves package URIs.
        given: Files from the user; no other files are searched.
    """
    found: list[tuple[Robot, ControlFile]] = []
    problems: list[Diagnostic] = []
    # The robots of a world are often in one folder.
    launches_in = cache(partial(launches_near, package_path=packages.package_path))
    for robot in robots:
        described = robot.description
        found += [
            (robot, ControlFile(path=_plain(path), named=True, robot=described)) for path in given
        ]
        for element in named_files(robot):
            path = resolved(packages, element)
            if isinstance(path, Path):
                file = ControlFile(path=path, named=True, element=element, robot=described)
                found.append((robot, file))
        if not given:
            launched = _launched(robot, launches_in)
            near = dict.fromkeys((*_near(robot), *map(_plain, launched.files)))
            found += [
                (robot, ControlFile(path=path, named=False, robot=described)) for path in near
            ]
            problems += launched.problems
    return found, problems


def _near(robot: Robot) -> Iterator[Path]:
    """The files near a robot of ROS 1 that contain its joints."""
    if is_of_ros1(robot):
        file = Path(robot.description.origin.file)
        joints = [joint.name for joint in robot.joints.values() if joint.type != "fixed"]
        found = files_for(file, joints, within=repository_of(file))
        yield from (path for path in found if _belongs(path, file))


def _launched(robot: Robot, launches_in: Callable[[Path], Sequence[LaunchUse]]) -> Selection:
    """What launch files load for the controllers of a robot; see `launches_near`."""
    file = Path(robot.description.origin.file)
    folder = root_of(file)
    if folder is None or not is_controlled(robot.description):
        return Selection(files=(), names=())
    launches = own_launches(file, launches_in(folder))
    use = chosen(file, launches)
    return selection(robot.description, use, launches, within=own_folder(file))


def named_files(robot: Robot) -> Iterator[Element]:
    """Tags that refer to a controller file."""
    for tag, _ in robot.plugins():
        if "ros2_control" in tag.filename:
            for element in tag.element.find_all("parameters"):
                if element.text.strip():
                    yield element


def resolved(packages: Packages, element: Element) -> Path | Diagnostic:
    """The file that a tag refers to, or a diagnostic if it cannot be found."""
    try:
        return packages.resolve(element.text.strip(), element.origin, what="file")
    except DescriptionError as error:
        return devices_codes.CONTROLLERS_FILE_UNREADABLE.diagnostic(
            message=f"{error.message}, so no controller starts",
            values={"file": element.text.strip()},
            origin=element.origin,
            hint=error.hint or "",
            mark=element.text.strip(),
        )


def is_of_ros1(robot: Robot) -> bool:
    """Whether ROS 1 controllers move the robot."""
    return any(
        "ros_control" in tag.filename and "ros2" not in tag.filename for tag, _ in robot.plugins()
    )


def _plain(path: Path) -> Path:
    """The path in ``NAME=FILE``, which names the controller in a file without one."""
    name, _, file = str(path).partition("=")
    return Path(file) if name and file and not path.exists() else path


def _belongs(path: Path, robot: Path) -> bool:
    """Whether a file is in the robot's package, or in a package named after it."""
    ours, theirs = (_package(each.absolute()) for each in (robot, path))
    if ours is None or theirs is None:
        return ours == theirs
    return ours == theirs or ours.name.split("_")[0] == theirs.name.split("_")[0]


def _package(file: Path) -> Path | None:
    return next((each for each in file.parents if package_name(each) is not None), None)
