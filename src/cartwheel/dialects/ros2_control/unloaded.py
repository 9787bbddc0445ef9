"""Hardware of ``<ros2_control>`` that Gazebo's plugins do not load, such as that of the real robot.

The plugins load only classes that are derived from an interface of their own package. They report
any other class and skip it, so that its joints have no interfaces. Source: gazebo_ros2_control and
gz_ros2_control.
"""

from __future__ import annotations

import re
from pathlib import Path

from cartwheel.description.files.packages import Packages
from cartwheel.description.files.plugin_xml import base_classes
from cartwheel.description.model import Element, PluginTag, RobotDescription
from cartwheel.dialects.catalogue import plugin_named, short_name
from cartwheel.dialects.ros_control.interfaces import (
    SYSTEMS,
    hardware_of,
    loaded_by,
    package_system,
)
from cartwheel.similar_names import meant_one

_MANAGER = re.compile(r"(gazebo|gz|ign)_ros2_control")
_DERIVED = re.compile(r"gazebo|ignition|(?<![a-z])gz", re.IGNORECASE)
"""Names of the interfaces from which hardware for Gazebo is derived."""
_MISSPELT = 0.88
"""Similarity from which a package is probably a misspelt one."""
_FOR_SIMULATION = re.compile(
    r"gazebo|(?<![a-z])(?:gz|ign)(?![a-z])|ignition|sim(?!pl)", re.IGNORECASE
)
"""Names of hardware that may be for Gazebo."""


def unloaded_systems(robot: RobotDescription) -> list[tuple[Element, PluginTag]]:
    """The ``<ros2_control>`` tags whose hardware the robot's plugin in Gazebo does not load.

    Hardware that may be for Gazebo, by the interface from which it is derived or by its name, is
    not among them, nor is hardware whose joints are also those of hardware that is loaded.

    Returns:
        The tags, each with the plugin.
    """
    manager = next((tag for tag in robot.plugins if _MANAGER.search(tag.filename)), None)
    if manager is None or any(_may_manage(tag) for tag in robot.plugins):
        return []
    loads = loaded_by(robot)
    served = {
        name
        for system in robot.ros2_control
        if hardware_of(system) in loads
        for name in _joints(system)
    }
    left = [
        system
        for system in robot.ros2_control
        if _joints(system) - served
        and hardware_of(system) not in loads
        and _is_named(hardware_of(system))
    ]
    foreign = {hardware_of(system) for system in left if not _is_simulated(hardware_of(system))}
    file = Path(robot.origin.file)
    bases = base_classes(file, foreign)
    return [
        (system, manager)
        for system in left
        if hardware_of(system) not in foreign
        or not _may_be_loaded(hardware_of(system), bases.get(hardware_of(system), ""))
        or (hardware_of(system) not in bases and misspelt(hardware_of(system), file))
    ]


def misspelt(hardware: str, robot: Path) -> str:
    """The hardware for Gazebo whose package is meant by a misspelt name; empty if there is none.

    Args:
        hardware: The class, such as ``gazbo_ros2_control/GazeboSystem``.
        robot: The file of the robot. The name is right if a package near it has this name.
    """
    package, _, name = hardware.replace("::", "/").partition("/")
    own = {each.partition("/")[0]: each for each in SYSTEMS}
    near = meant_one(package, own, cutoff=_MISSPELT)
    classes = (each.partition("/")[2] for each in SYSTEMS)
    if not near or not meant_one(name, classes, cutoff=_MISSPELT) or any(e in package for e in own):
        # Another package may have a name that contains the known one.
        return ""
    return "" if Packages(robot).found(package) is not None else own[near]


def _may_manage(tag: PluginTag) -> bool:
    """Whether an unsupported plugin may run controllers, with hardware of its own."""
    return "control" in short_name(tag.filename) and plugin_named(tag.filename) is None


def _joints(system: Element) -> set[str]:
    """The joints of a system that can be commanded."""
    return {
        (joint.attribute("name") or "").strip()
        for joint in system.find_all("joint")
        if joint.find("command_interface") is not None
    }


def _is_named(hardware: str) -> bool:
    return bool(hardware) and "$" not in hardware


def _is_simulated(hardware: str) -> bool:
    """Whether hardware is in a package that contains simulated hardware."""
    return hardware in SYSTEMS or bool(package_system(hardware))


def _may_be_loaded(hardware: str, base: str) -> bool:
    """Whether hardware that is not simulated may be for Gazebo."""
    return bool(_DERIVED.search(base) if base else _FOR_SIMULATION.search(hardware))
