"""Plugins that exist only in the version of ROS for which a robot's package is not built."""

from __future__ import annotations

import itertools
from pathlib import Path

from cartwheel.checks.robot import Robot
from cartwheel.codes import devices
from cartwheel.description.files.package_folders import packages_below
from cartwheel.description.files.repositories import repository_of
from cartwheel.description.files.ros_version import ros_version
from cartwheel.description.model import PluginTag
from cartwheel.dialects.catalogue import short_name
from cartwheel.dialects.ros_only import only_in
from cartwheel.errors import Diagnostic

_PACKAGES, _BYTES = 200, 100_000
"""Packages of a repository whose CMakeLists.txt is searched, and bytes of each file."""


def other_ros(robot: Robot, tag: PluginTag) -> Diagnostic | None:
    """The finding that Gazebo cannot load a plugin, because it is for another version of ROS.

    None if the version of the robot's package is unknown, or if its repository builds a plugin of
    this name.

    Args:
        robot: The robot.
        tag: One of its plugins.
    """
    only = only_in(tag.filename)
    if only is None:
        return None
    file = Path(robot.description.origin.file)
    own = ros_version(file)
    if own is None or own == only[0] or _builds(file, short_name(tag.filename)):
        return None
    return devices.PLUGIN_OF_OTHER_ROS.diagnostic(
        f'the plugin "{tag.filename}" exists only in ROS {only[0]}, but the package of the robot '
        f"is built for ROS {own}, so Gazebo does not load the plugin",
        origin=tag.origin,
        hint=f"In ROS {own}, use {only[1]}." if only[1] else "",
        mark=tag.filename,
        values={"plugin": tag.filename, "exists": float(only[0]), "ros": float(own)},
    )


def _builds(file: Path, name: str) -> bool:
    """Whether a package in the repository of a file builds a library of this name."""
    root = repository_of(file)
    if root is None:
        return False
    folders = itertools.chain([root], (folder for _, folder in packages_below(root)))
    for folder in itertools.islice(folders, _PACKAGES):
        try:
            with (folder / "CMakeLists.txt").open("rb") as text:
                if name.encode() in text.read(_BYTES):
                    return True
        except OSError:
            continue
    return False
