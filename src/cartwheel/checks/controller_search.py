"""Finds the controller files of a robot: files it refers to, or files a launch file may load."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from cartwheel.checks.controller_files import ControlFile
from cartwheel.checks.robot import Robot
from cartwheel.codes import devices as devices_codes
from cartwheel.description.files.package_folders import package_name
from cartwheel.description.files.packages import Packages
from cartwheel.description.files.repositories import repository_of
from cartwheel.description.launches import LaunchSearch, OwnLaunches, chosen
from cartwheel.description.model import Element
from cartwheel.dialects.ros_control.selection import Selection, selection
from cartwheel.dialects.ros_control.suggestion import files_for, is_controlled
from cartwheel.errors import DescriptionError, Diagnostic


def controller_files_of(
    robots: Sequence[Robot],
    packages: Packages,
    given: Sequence[Path],
    search: Callable[[Path], OwnLaunches] | None = None,
) -> tuple[list[tuple[Robot, ControlFile]], list[tuple[Robot, Selection]]]:
    """The controller files of each robot, and what launch files load for those with a controller
    manager.

    Args:
        robots: Robots in the description.
        packages: Resolves package URIs.
        given: Files from the user; no other files are searched.
        search: Returns the launch files of a description's author; None to search them.
    """
    found: list[tuple[Robot, ControlFile]] = []
    selected: list[tuple[Robot, Selection]] = []
    # The robots of a world are often in one folder.
    search = search or LaunchSearch(packages.package_path).of
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
            near = dict.fromkeys(_near(robot))
            if is_controlled(described):
                launched = _launched(robot, search)
                near |= dict.fromkeys(map(_plain, launched.files))
                selected.append((robot, launched))
            found += [
                (robot, ControlFile(path=path, named=False, robot=described)) for path in near
            ]
    return found, selected


def _near(robot: Robot) -> Iterator[Path]:
    """The files near a robot of ROS 1 that contain its joints."""
    if is_of_ros1(robot):
        file = Path(robot.description.origin.file)
        joints = [joint.name for joint in robot.joints.values() if joint.type != "fixed"]
        found = files_for(file, joints, within=repository_of(file))
        yield from (path for path in found if _belongs(path, file))


def _launched(robot: Robot, search: Callable[[Path], OwnLaunches]) -> Selection:
    """What launch files load for the controllers of a robot."""
    file = Path(robot.description.origin.file)
    own = search(file)
    use = chosen(file, own.launches)
    return selection(robot.description, use, own.launches, within=own.folder)


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
