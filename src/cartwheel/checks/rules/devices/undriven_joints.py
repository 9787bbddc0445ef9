"""Whether anything holds the joints of an arm."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from cartwheel.checks import plugin_tags
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.codes import robot as robot_codes
from cartwheel.description.files.ros_version import ros_version
from cartwheel.description.model import Joint, PluginTag, RobotDescription
from cartwheel.dialects.catalogue import plugin_named, short_name
from cartwheel.dialects.ros_control.control_plugin import ControlPlugin
from cartwheel.dialects.tag_roles import WHEEL_ROLES
from cartwheel.errors import Diagnostic

_SHOWN = 3


@rule(robot_codes.JOINTS_UNDRIVEN)
def undriven_joints(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        description = robot.description
        if description.static or any(map(may_drive, description.plugins)):
            continue
        free = [joint for joint in description.joints if _is_free(joint)]
        if not free:
            continue
        yield robot_codes.JOINTS_UNDRIVEN.diagnostic(
            f"no plugin drives {_names(free)}, so gravity can move "
            f"{'it' if len(free) == 1 else 'them'}",
            origin=free[0].origin,
            hint=_hint(description),
            values={"joints": tuple(joint.name for joint in free)},
        )


def _hint(description: RobotDescription) -> str:
    """Which plugin to add, by the version of ROS for which the robot's package is built."""
    version = ros_version(Path(description.origin.file))
    add = 'add <gazebo><plugin name="control" filename="{}"/></gazebo>.'
    if description.ros2_control:
        manager = add.format("libgazebo_ros2_control.so")
        return f"The robot has <ros2_control>, which only a controller manager uses: {manager}"
    if version == 2:
        extra = "<transmission>s have no effect in ROS 2: " if description.transmissions else ""
        hint = f"{extra}add a plugin that drives them, such as gz_ros2_control with <ros2_control>."
        return hint[0].upper() + hint[1:]
    if description.transmissions:
        manager = add.format("libgazebo_ros_control.so")
        return f"The robot has <transmission>s, which only a controller manager uses: {manager}"
    return "Add a plugin that drives them, such as gazebo_ros_control or gz_ros2_control."


def _names(joints: list[Joint]) -> str:
    names = ", ".join(f'"{joint.name}"' for joint in joints[:_SHOWN])
    more = f" and {len(joints) - _SHOWN} more" if len(joints) > _SHOWN else ""
    return f"joint{'s' if len(joints) > 1 else ''} {names}{more}"


def _is_free(joint: Joint) -> bool:
    """Whether a joint is one of an arm rather than a wheel, and nothing resists its motion."""
    axis = joint.axis
    return (
        joint.type in ("revolute", "prismatic")
        and joint.mimic is None
        and not axis.locks
        and not axis.friction
        and not axis.spring_stiffness
    )


def may_drive(tag: PluginTag) -> bool:
    """Whether a plugin drives joints, or is unknown, so that it may."""
    return not plugin_tags.is_simulated(tag) or drives_joints(tag)


def drives_joints(tag: PluginTag) -> bool:
    """Whether a plugin drives joints, or runs controllers, by its name if it is unknown."""
    plugin = plugin_named(tag.filename)
    return (
        (plugin is not None and issubclass(plugin, ControlPlugin))
        or "control" in short_name(tag.filename)
        or bool(plugin_tags.roles_with(tag.filename, "joint", "other_joint", *WHEEL_ROLES))
    )
