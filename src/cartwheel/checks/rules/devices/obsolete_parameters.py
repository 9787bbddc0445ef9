"""Parameters that Gazebo 11 ignores."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from cartwheel.checks import edits, nodes, plugin_tags
from cartwheel.checks.robot import Drive
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.checks.wheels import is_legacy, wheel_pairs
from cartwheel.codes import devices as devices_codes
from cartwheel.dialects.ros_only import ros_of
from cartwheel.dialects.wheel_pairs import are_swapped
from cartwheel.errors import Diagnostic

_TORQUE = {1: "wheelTorque", 2: "max_wheel_torque"}
"""The tag of the wheel torque by the version of ROS."""


@rule(devices_codes.PLUGIN_PARAMETER_OBSOLETE)
def plugin_obsolete(subject: Subject) -> Iterator[Diagnostic]:
    swapped = [
        drive
        for robot, drive, left, right in wheel_pairs(subject)
        if is_legacy(drive) and are_swapped(robot.description, left.name, right.name)
    ]
    for robot in subject.robots:
        for drive in robot.drives:
            element = drive.tag.element
            if "gazebo_ros_diff_drive" not in drive.tag.filename:
                continue
            for torque in plugin_tags.roles_with(drive.tag.filename, "wheel_torque"):
                stated = {name: found for name in torque.tags if (found := element.find(name))}
                if any(name not in torque.obsolete for name in stated):
                    continue
                for name, each in stated.items():
                    if nodes.number(each.text) == torque.default[0]:
                        continue
                    yield devices_codes.PLUGIN_PARAMETER_OBSOLETE.diagnostic(
                        message=f"Gazebo 11 ignores <{name}>, so the wheel torque is "
                        f"{torque.default[0]:g} N m instead of {each.text.strip()} N m",
                        values={
                            "tag": name,
                            "plugin": drive.tag.name,
                            "stated": nodes.number(each.text) or 0.0,
                            "used": float(torque.default[0]),
                        },
                        **edits.whole(
                            each, nodes.written(_TORQUE[_ros(drive)], {}, each.text.strip())
                        ),
                    )
            legacy = element.find("legacyMode")
            # If the wheels are swapped, another rule reports that they are.
            if (
                legacy is not None
                and is_legacy(drive)
                and not any(drive is each for each in swapped)
            ):
                yield devices_codes.PLUGIN_PARAMETER_OBSOLETE.diagnostic(
                    message="Gazebo 11 ignores <legacyMode>: the robot turns as commanded, because "
                    "the wheels are on the sides that the tags state",
                    values={"tag": "legacyMode", "plugin": drive.tag.name},
                    **edits.whole(legacy, "<legacyMode>false</legacyMode>"),
                )


def _ros(drive: Drive) -> int:
    """The version of ROS for which a drive is written: that of its package, or by its tags."""
    element = drive.tag.element
    stated = ros_of(Path(element.origin.file), drive.tag)
    return stated or (1 if element.find("left_joint") is None else 2)
