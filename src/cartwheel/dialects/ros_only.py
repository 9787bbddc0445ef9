"""Plugins for Gazebo Classic that exist in only one version of ROS.

From the branches ``noetic-devel`` and ``ros2`` of gazebo_ros_pkgs, and from gazebo_ros2_control.
"""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Literal

from cartwheel.codes import devices
from cartwheel.description.files.package_folders import packages_below
from cartwheel.description.files.regular_files import read_start
from cartwheel.description.files.repositories import repository_of
from cartwheel.description.files.ros_version import ros_version
from cartwheel.description.model import Element, PluginTag, RobotDescription
from cartwheel.dialects.catalogue import plugin_named, short_name
from cartwheel.errors import Diagnostic

_RAYS, _CAMERA = "libgazebo_ros_ray_sensor.so", "libgazebo_ros_camera.so"
_REPLACEMENTS: Mapping[int, Mapping[str, str]] = {
    1: {
        "gazebo_ros_control": "libgazebo_ros2_control.so with a <ros2_control> element",
        "gazebo_ros_block_laser": _RAYS,
        "gazebo_ros_gpu_laser": _RAYS,
        "gazebo_ros_laser": _RAYS,
        "gazebo_ros_range": _RAYS,
        "gazebo_ros_depth_camera": _CAMERA,
        "gazebo_ros_multicamera": _CAMERA,
        "gazebo_ros_openni_kinect": _CAMERA,
        "gazebo_ros_prosilica": _CAMERA,
        "gazebo_ros_triggered_camera": _CAMERA,
        "gazebo_ros_triggered_multicamera": _CAMERA,
        "gazebo_ros_f3d": "libgazebo_ros_ft_sensor.so",
        "gazebo_ros_imu": "libgazebo_ros_imu_sensor.so",
        "gazebo_ros_skid_steer_drive": "libgazebo_ros_diff_drive.so with <num_wheel_pairs>",
    },
    2: {
        "gazebo_ros2_control": "libgazebo_ros_control.so with <transmission> elements",
        "gazebo_ros_ray_sensor": "libgazebo_ros_laser.so",
        "gazebo_ros_ackermann_drive": "",
        "gazebo_ros_gps_sensor": "",
    },
}
"""By the version of ROS in which a plugin exists: what to use in the other one; empty if there is
nothing alike."""


_REQUIRED: Mapping[str, tuple[tuple[str, str], ...]] = {
    "gazebo_ros_diff_drive": (("leftJoint", "left_joint"), ("rightJoint", "right_joint")),
    "gazebo_ros_p3d": (("bodyName", "body_name"),),
    "gazebo_ros_ft_sensor": (("jointName", "joint_name"),),
}
"""Tags without which a plugin of both versions does not work: in ROS 1, and in ROS 2."""


_ROS_PACKAGE = "gazebo_ros_"
"""Beginning of the names of gazebo_ros_pkgs' plugins."""
_ROS2_CONTROL = ("gazebo_ros2_control", "gz_ros2_control-system", "ign_ros2_control-system")
"""Plugins of ros2_control, whose tags contain no capital letters either."""
_PACKAGES, _BYTES = 200, 100_000
"""Packages of a repository whose CMakeLists.txt is searched, and bytes of each file."""


def only_in(filename: str) -> tuple[Literal[1, 2], str] | None:
    """The only version of ROS in which a plugin exists, and its replacement in the other one.

    Args:
        filename: Name in a ``<plugin>`` tag.

    Returns:
        None for plugins that exist in both versions, and for all that are not part of Gazebo's
        packages.
    """
    name = short_name(filename)
    if name in _REPLACEMENTS[1]:
        return 1, _REPLACEMENTS[1][name]
    return (2, _REPLACEMENTS[2][name]) if name in _REPLACEMENTS[2] else None


def ros_of(file: Path, tag: PluginTag) -> Literal[1, 2] | None:
    """The version of ROS of a plugin: that of its package, or else ROS 2 if it has a ``<ros>``.

    Args:
        file: A file of the package.
        tag: The plugin.

    Returns:
        None if neither states it.
    """
    return ros_version(file) or (2 if tag.element.find("ros") is not None else None)


def other_tags(robot: RobotDescription, tag: PluginTag) -> Diagnostic | None:
    """The finding that a plugin does not work, because its tags are those of another ROS version.

    None if the version is unknown. A ``<ros>`` element shows that a plugin is for ROS 2, unless the
    package of the robot is for ROS 1.

    Args:
        robot: The robot.
        tag: One of its plugins.
    """
    required = _REQUIRED.get(short_name(tag.filename), ())
    if not required:
        return None
    file = Path(robot.origin.file)
    own = ros_of(file, tag)
    if own is None or _builds(file, short_name(tag.filename)):
        return None
    for first, second in required:
        mine, theirs = (first, second) if own == 1 else (second, first)
        stated = tag.element.find(theirs)
        # ROS 1's default for the joint is the name of ROS 2's tag.
        if tag.element.find(mine) is None and stated is not None and stated.text.strip() != second:
            return devices.PLUGIN_OF_OTHER_ROS.diagnostic(
                f'the plugin "{tag.filename}" of ROS {own} reads <{mine}>, not <{theirs}>, so it '
                "does not work",
                origin=stated.origin,
                hint=f"Write <{mine}>, and the other tags as in ROS {own}.",
                mark=theirs,
                values={"plugin": tag.filename, "tag": theirs, "ros": float(own)},
            )
    return None


def unread_tags(robot: RobotDescription, tag: PluginTag) -> Iterator[tuple[Element, str]]:
    """The tags of a plugin that only ROS 1 reads, each with what to write in ROS 2.

    None unless the plugin is one of ros2_control, or of gazebo_ros_pkgs for ROS 2, by the package
    of the robot or, if that is unknown, by its ``<ros>`` element. Their tags contain no capital
    letters.
    """
    name, file = short_name(tag.filename), Path(robot.origin.file)
    plugin = plugin_named(tag.filename)
    of_ros2 = name.startswith(_ROS_PACKAGE) and ros_of(file, tag) == 2
    if plugin is None or not (of_ros2 or name in _ROS2_CONTROL):
        return
    if name in _REPLACEMENTS[1]:
        return
    advice = {"robotNamespace": "In ROS 2, write <ros><namespace>."}
    for item in dataclasses.fields(plugin.parameters):
        tags: tuple[str, ...] = item.metadata["tags"]
        new = next((each for each in tags if each.islower()), None)
        for each in tags if new is not None else ():
            if each.endswith("Topic") or each.startswith("topic"):
                advice[each] = "In ROS 2, rename topics with <ros><remapping>."
            elif each == "updateRate" and plugin.for_sensor:
                advice[each] = "In ROS 2, state the <update_rate> of the <sensor>."
            else:
                advice[each] = f"In ROS 2, write <{new}>."
    found = [
        (each, advice[each.tag])
        for each in tag.element.children
        if each.tag in advice and not each.tag.islower()
    ]
    if found and not _builds(file, name):
        yield from found


def other_ros(robot: RobotDescription, tag: PluginTag) -> Diagnostic | None:
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
    file = Path(robot.origin.file)
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


def is_built(robot: RobotDescription, tag: PluginTag) -> bool:
    """Whether a package in the repository of a robot builds a library of a plugin's name."""
    return _builds(Path(robot.origin.file), short_name(tag.filename))


def _builds(file: Path, name: str) -> bool:
    """Whether a package in the repository of a file builds a library of this name."""
    root = repository_of(file)
    if root is None:
        return False
    folders = itertools.chain([root], (folder for _, folder in packages_below(root)))
    for folder in itertools.islice(folders, _PACKAGES):
        try:
            if name.encode() in read_start(folder / "CMakeLists.txt", _BYTES):
                return True
        except OSError:
            continue
    return False
