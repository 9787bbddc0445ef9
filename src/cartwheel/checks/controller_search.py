"""Finds the controller files of a robot: files it refers to, or files a launch file may load."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from cartwheel.checks.controller_files import ControlFile
from cartwheel.checks.robot import Robot
from cartwheel.codes import devices as devices_codes
from cartwheel.description.files.package_folders import package_name
from cartwheel.description.files.packages import Packages
from cartwheel.description.files.repositories import repository_of
from cartwheel.description.launches import LaunchSearch, OwnLaunches, chosen
from cartwheel.description.model import Element
from cartwheel.dialects.ros_control.files import name_and_file
from cartwheel.dialects.ros_control.launched.mentions import started_by_others
from cartwheel.dialects.ros_control.selection import Selection, selection
from cartwheel.dialects.ros_control.suggestion import files_for, is_controlled
from cartwheel.errors import DescriptionError, Diagnostic


def controller_files_of(
    robots: Sequence[Robot],
    packages: Packages,
    given: Sequence[Path],
    search: Callable[[Path], OwnLaunches] | None = None,
    chosen_before: Selection | None = None,
) -> tuple[list[tuple[Robot, ControlFile]], list[tuple[Robot, Selection]]]:
    """The controller files of each robot, and what launch files load for those with a controller
    manager.

    Args:
        robots: Robots in the description.
        packages: Resolves package URIs.
        given: Files from the user; no other files are searched.
        search: Returns the launch files of a description's author; None to search them.
        chosen_before: What launch files load, if `given` was taken from them.
    """
    found: list[tuple[Robot, ControlFile]] = []
    selected: list[tuple[Robot, Selection]] = []
    # The robots of a world are often in one folder.
    search = search or LaunchSearch(packages.package_path).of
    for robot in robots:
        described = robot.description
        own = [_file(path, robot, named=True) for path in given]
        for element in named_files(robot):
            path = resolved(packages, element)
            if isinstance(path, Path):
                own.append(replace(_file(path, robot, named=True), element=element))
        launched = chosen_before
        if not given and is_controlled(described):
            launched = launched or _launched(robot, search)
        if not given:
            stated = {} if launched is None else {name_and_file(p)[1]: p for p in launched.files}
            near = {path: path for path in _near(robot)} | stated
            own += [_file(path, robot, named=False) for path in near.values()]
        if launched is not None and is_controlled(described):
            selected.append((robot, launched))
            own = [*_used(own, launched, Path(described.origin.file))]
        found += [(robot, file) for file in own]
    return found, selected


def _file(path: Path, robot: Robot, *, named: bool) -> ControlFile:
    """A file, or one controller of which ``NAME=FILE`` states the name."""
    name, file = name_and_file(path)
    return ControlFile(path=file, named=named, robot=robot.description, name=name)


def _used(files: Sequence[ControlFile], launched: Selection, robot: Path) -> Iterator[ControlFile]:
    """The files with the names of those of their controllers that run.

    They are those that launch files start, and those that programs and instructions may start. All
    of them may run if no launch file starts any of them.
    """
    written = {each.name for file in files for each in file.written}
    used = launched.used & written
    if used and used != written:
        used |= started_by_others(robot, written - used)
    yield from (replace(file, used=used) for file in files)


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
        return packages.resolve(
            element.text.strip(), element.origin, what="file", use="controllers"
        )
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


def _belongs(path: Path, robot: Path) -> bool:
    """Whether a file is in the robot's package, or in a package named after it."""
    ours, theirs = (_package(each.absolute()) for each in (robot, path))
    if ours is None or theirs is None:
        return ours == theirs
    return ours == theirs or ours.name.split("_")[0] == theirs.name.split("_")[0]


def _package(file: Path) -> Path | None:
    return next((each for each in file.parents if package_name(each) is not None), None)
