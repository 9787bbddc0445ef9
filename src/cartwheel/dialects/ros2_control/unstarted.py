"""Plugins of ros2_control that start no controller manager in Gazebo."""

from __future__ import annotations

from pathlib import Path

from cartwheel.codes.devices import CONTROL_WITHOUT_JOINTS, CONTROLLERS_NOT_FOUND
from cartwheel.codes.files import INCLUDE_ABSENT, MACRO_ABSENT
from cartwheel.description.model import PluginTag, RobotDescription
from cartwheel.dialects.catalogue import short_name
from cartwheel.errors import Diagnostic

_STRICT = ("gz_ros2_control-system", "ign_ros2_control-system")
"""Those that need ``<parameters>``. Source: gz_ros2_control and ign_ros2_control."""

_SDF = frozenset({".sdf", ".world"})


def states_files(tag: PluginTag) -> bool:
    """Whether a plugin has a ``<parameters>`` tag that is not empty."""
    return any(each.text.strip() for each in tag.element.find_all("parameters"))


def without_parameters(tag: PluginTag) -> Diagnostic | None:
    """The finding that a plugin starts no controller manager, because it has no ``<parameters>``.

    None for other plugins. That of gazebo_ros2_control starts the manager without parameters.
    """
    if short_name(tag.filename) not in _STRICT or states_files(tag):
        return None
    return CONTROLLERS_NOT_FOUND.diagnostic(
        f'"{tag.filename}" has no <parameters>, without which it does not start the controller '
        "manager in Gazebo",
        origin=tag.origin,
        values={"started": (), "plugin": tag.filename, "tag": "parameters"},
        hint="Add <parameters>$(find PACKAGE)/config/controllers.yaml</parameters>.",
    )


def without_hardware(robot: RobotDescription, tag: PluginTag) -> Diagnostic | None:
    """The finding that a plugin starts no controller manager, because a URDF has no
    ``<ros2_control>``.

    None for an SDF model, whose URDF may have it, and if a file is absent that may contain it.
    Source: gazebo_ros2_control and gz_ros2_control.
    """
    suffixes = Path(robot.origin.file).suffixes
    absent = any(each.code in (INCLUDE_ABSENT, MACRO_ABSENT) for each in robot.diagnostics)
    if robot.ros2_control or absent or not _SDF.isdisjoint(suffixes):
        return None
    return CONTROL_WITHOUT_JOINTS.diagnostic(
        f'the description has no <ros2_control>, without which "{tag.filename}" does not start the '
        "controller manager in Gazebo",
        severity="error",
        origin=tag.origin,
        values={"plugin": tag.filename},
        hint="Add a <ros2_control> with the hardware for Gazebo and the joints.",
    )
