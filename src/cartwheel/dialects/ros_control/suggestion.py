"""Controller files, and launch files, for a robot whose controller manager has none."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from cartwheel import yaml_text
from cartwheel.codes.running import CONTROLLERS_NOT_NAMED
from cartwheel.description.files.package_folders import package_name
from cartwheel.description.files.source_folders import source_folders
from cartwheel.description.launches import LaunchUse, controllers_for
from cartwheel.description.model import PluginTag, RobotDescription
from cartwheel.dialects.catalogue import OF_FETCH, ROS_CONTROL, plugin_named
from cartwheel.dialects.ros_control.files import (
    ControllerEntry,
    controller_entries,
    is_ros2,
    moved_file,
    name_and_file,
    read_parameters,
    ros2_file,
    stated_path,
)
from cartwheel.dialects.ros_control.launch_arguments import texts
from cartwheel.dialects.ros_control.launched.names import ros1_entries
from cartwheel.dialects.ros_control.steer_bot import PARAMETERS
from cartwheel.dialects.tags import roles_of
from cartwheel.errors import CartwheelError, Diagnostic, PluginError

_ROS2_CONTROL = "gz_ros2_control-system"
_TYPES_OF_FETCH = "robot_controllers/"
"""Files of Fetch's plugin list the joints below ``gazebo``, because a drive need not name them."""
_ARGUMENT = re.compile(r"\$\((?:arg|var)\s+[^()]*\)")
_BROADCASTS = "joint_state"
"""Part of the types that publish joint states."""
_PUBLISHES = re.compile(r"joint_state|Broadcaster$|imu_sensor|force_torque_sensor")
"""Types that command no joint."""
_JOINTS = re.compile(r"joint|wheel|dof_names")
"""Names of parameters with the joints that a controller commands."""
_ARGUMENT_WITH_END = re.compile(_ARGUMENT.pattern + r"([\w/]*)")
"""Also what follows in the same word, or the beginning of it."""
_LEVELS = 4
"""Number of folders above the robot's file that are searched for its package."""
_MOST = 400
"""Maximum number of files to read."""


def suggested(
    robot: RobotDescription,
    among: Sequence[Path] | None = None,
    *,
    within: Path | None = None,
    started: bool = True,
) -> list[Path]:
    """Returns the controller files near a robot whose controller manager has none.

    Returns nothing if the manager's tag contains an existing file, unless that contains no
    controller, and a launch file passes files with some to spawners. Files near the robot with
    controllers for wheels that a plugin drives are left out, because both would command the wheels.
    Those that a launch file starts command them in Gazebo as well.

    Args:
        robot: The robot.
        among: Files to choose from, such as those that a launch file loads; None: all files near
            the robot.
        within: A folder; files near the robot are used only if they are in it.
        started: Whether a launch file may start the controllers of the files in `among`, and does
            not only load their parameters.
    """
    driven = {
        joint
        for tag in robot.plugins
        if (plugin := plugin_named(tag.filename)) is not None
        for role in roles_of(plugin.parameters)
        if role.role in ("left_wheel", "right_wheel", "left_wheels", "right_wheels")
        for joint in role.joints(tag.element)
    }
    movable = [each.name for each in robot.joints if each.type != "fixed"]
    joints = [name for name in movable if name not in driven]
    managers = [tag for tag in robot.plugins if _manager(tag)]
    has_own = not lacks_controllers(robot) and (among is None or _has_entries(robot))
    if not managers or has_own:
        return []
    ros2 = _manager(managers[0]) != ROS_CONTROL
    if among is not None:
        return with_controllers(among, movable if started else joints, ros2=ros2)
    return files_for(Path(robot.origin.file), joints, ros2=ros2, within=within)


def commanding(robot: RobotDescription, among: Sequence[Path]) -> bool:
    """Whether one of the files contains controllers for a robot's joints."""
    joints = [each.name for each in robot.joints if each.type != "fixed"]
    return any(named for ros2 in (False, True) for _, named in _fitting(among, joints, ros2=ros2))


def _commands_others(robot: RobotDescription, among: Sequence[Path]) -> bool:
    """Whether files contain controllers for joints, but none of them is a joint of the robot."""
    return any(map(_commands, among)) and not commanding(robot, among)


def _commands(path: Path) -> bool:
    """Whether a file contains a controller for joints."""
    try:
        content = read_parameters(path)
    except PluginError:
        return False
    entries = _entries(content, str(path), ros2=is_ros2(content))
    return any(
        _PUBLISHES.search(entry.type) is None
        and any(_JOINTS.search(str(name)) for name in entry.values)
        for entry in entries
    )


def starter_of(
    robot: RobotDescription, use: LaunchUse | None, launches: Sequence[LaunchUse]
) -> LaunchUse | None:
    """The launch file that starts a robot's controllers.

    One without a description whose controllers command only joints of another robot is none.
    """
    if use is not None and (use.spawned or use.loaded):
        return use
    found = controllers_for(Path(robot.origin.file), use, launches)
    if found is None or found is use or not _commands_others(robot, found.controllers):
        return found
    return None


def is_controlled(robot: RobotDescription) -> bool:
    """Whether the robot has a controller manager."""
    return any(_manager(tag) for tag in robot.plugins)


def is_of_ros1(robot: RobotDescription) -> bool:
    """Whether the robot has a controller manager of ROS 1."""
    return any(_manager(tag) == ROS_CONTROL for tag in robot.plugins)


def lacks_controllers(robot: RobotDescription) -> bool:
    """Whether the robot has a controller manager whose tag contains no existing file."""
    managers = [tag for tag in robot.plugins if _manager(tag)]
    return bool(managers) and not any(_has_files(tag) for tag in managers)


def files_for(
    robot: Path, joints: Sequence[str], *, ros2: bool = False, within: Path | None = None
) -> list[Path]:
    """Returns YAML files with controllers for a robot's joints, or for the states of all joints.

    The folders named ``config`` in the robot's package and in the packages beside it are searched,
    and the other folders of the robot's package if they contain no controllers for the joints.
    If its own package contains controllers for the joints, those of the packages beside it are for
    other robots with equal joints. Files that only publish the states of all joints must be in a
    package with controllers for the joints, or in the robot's own.

    Args:
        robot: File of the robot.
        joints: Names of the movable joints.
        ros2: Search for ROS 2 parameter files.
        within: A folder; files outside of it are not used.
    """
    package = _package(robot)
    own: list[tuple[Path, bool]] = []
    others: list[tuple[Path, bool]] = []
    for path, named in _fitting(_candidates(package, within), joints, ros2=ros2):
        (own if package in path.parents else others).append((path, named))
    if package is not None and not any(named for _, named in own + others):
        own += [each for each in _fitting(_elsewhere(package), joints, ros2=ros2) if each[1]]
    homes = {_home(path, package) for path, named in own + others if named}
    if any(named for _, named in own):
        others = [(path, named) for path, named in others if not named]
    kept = [path for path, _ in others if _home(path, package) in homes]
    return sorted([path for path, _ in own] + kept)


def _home(path: Path, package: Path | None) -> Path | None:
    """The package of a file: the robot's own, or one beside it."""
    if package is None:
        return None
    return package.parent / path.relative_to(package.parent).parts[0]


def with_controllers(
    paths: Iterable[Path], joints: Sequence[str], *, ros2: bool = False
) -> list[Path]:
    """Returns the files with controllers for a robot's joints, or for the states of all joints.

    Args:
        paths: YAML files.
        joints: Names of the movable joints.
        ros2: Search for ROS 2 parameter files.
    """
    return [path for path, _ in _fitting(paths, joints, ros2=ros2)]


def _fitting(
    paths: Iterable[Path], joints: Sequence[str], *, ros2: bool
) -> Iterator[tuple[Path, bool]]:
    """The files, each with whether it contains controllers for the joints."""
    for path in paths:
        try:
            # Reading a file as YAML takes a hundred times as long as searching its text.
            if not _can_fit(yaml_text.read(name_and_file(path)[1]), joints):
                continue
            content = read_parameters(path)
        except (CartwheelError, OSError, UnicodeDecodeError):
            continue
        if is_ros2(content) != ros2:
            continue
        entries = _entries(content, str(path), ros2=ros2)
        values = [entry.values for entry in entries]
        if not ros2:
            values.append(content.get(PARAMETERS, {}))
            if any(entry.type.startswith(_TYPES_OF_FETCH) for entry in entries):
                values.append(content.get("gazebo", {}))
        words = {word for each in values for word in texts(each)}
        named = any(_names(word, joint) for joint in joints for word in words)
        broadcasts = len(entries) == 1 and _BROADCASTS in entries[0].type
        if named or broadcasts:
            yield path, named


def _can_fit(text: str, joints: Sequence[str]) -> bool:
    """Whether a file can contain a name of a joint, or a type that publishes joint states.

    It may contain neither, but a file for which the answer is False contains none.
    """
    # An escape sequence can hide a name.
    if any(word in text for word in (_BROADCASTS, "\\", *joints)):
        return True
    ends = _ARGUMENT_WITH_END.findall(text)
    return any(end in joint for end in ends for joint in joints)


def _manager(tag: PluginTag) -> str:
    """Returns which controller manager a plugin is, by its name; empty for other plugins."""
    plugin = plugin_named(tag.filename)
    if plugin is not None and plugin is plugin_named(OF_FETCH):
        # Its controllers are in files of ROS 1 as well.
        return ROS_CONTROL
    for name in (ROS_CONTROL, _ROS2_CONTROL):
        if plugin is not None and plugin is plugin_named(name):
            return name
    return ""


def _has_files(tag: PluginTag) -> bool:
    """Whether a file is stated that exists, also at a different place than stated."""
    return any(
        stated_path(each.text, tag.origin).is_file() or moved_file(each.text, tag.origin)[0]
        for each in tag.element.find_all("parameters")
    )


def _has_entries(robot: RobotDescription) -> bool:
    """Whether the files in the tags of the controller managers contain controllers, as far as they
    can be read.
    """
    for tag in filter(_manager, robot.plugins):
        for each in tag.element.find_all("parameters"):
            path = stated_path(each.text, tag.origin)
            path = path if path.is_file() else moved_file(each.text, tag.origin)[0] or path
            try:
                content = read_parameters(path)
            except PluginError:
                return True
            if _entries(content, str(path), ros2=is_ros2(content)):
                return True
    return False


def _entries(content: Mapping[str, Any], source: str, *, ros2: bool) -> list[ControllerEntry]:
    if not ros2:
        return ros1_entries(content, source)
    return controller_entries(ros2_file([content], ""), "", source)


def _package(robot: Path) -> Path | None:
    folders = robot.resolve().parents[:_LEVELS]
    return next((each for each in folders if package_name(each) is not None), None)


def _candidates(package: Path | None, within: Path | None) -> Iterator[Path]:
    if package is None:
        return
    seen = 0
    root = within.resolve() if within is not None else package.parent
    for folder in sorted(package.parent.iterdir()):
        if package_name(folder) is None or not (folder == package or folder.is_relative_to(root)):
            continue
        for path in sorted(folder.glob("**/config/**/*.y*ml")):
            seen += 1
            if seen > _MOST:
                return
            yield path


def _elsewhere(package: Path) -> Iterator[Path]:
    """YAML files of a package outside its folders named ``config``."""
    seen = 0
    for folder, names in source_folders(package):
        if "config" in folder.relative_to(package).parts:
            continue
        for name in names:
            if name.endswith((".yaml", ".yml")):
                seen += 1
                if seen > _MOST:
                    return
                yield folder / name


def _names(word: str, joint: str) -> bool:
    """Whether a word contains a joint's name, or ends like it after ``$(arg prefix)``."""
    rest = _ARGUMENT.sub("", word)
    return joint in word or (rest != word and len(rest) > 1 and joint.endswith(rest))


def no_controllers(robot: RobotDescription, found: Sequence[Path]) -> Diagnostic:
    """The warning for a robot with a controller manager without controllers.

    Args:
        robot: The robot.
        found: Files that could be meant.
    """
    files = tuple(str(file) for file in found)
    listed = f": {', '.join(files)}" if files else ""
    return CONTROLLERS_NOT_NAMED.diagnostic(
        f'robot "{robot.name}" has a controller manager, but no controllers are named, so nothing '
        "drives its joints",
        origin=robot.origin,
        hint='Pass controllers="auto", or the controller files'
        f"{listed}. Pass controllers=() to load controllers later.",
        values={"model": robot.name, "files": files},
    )
