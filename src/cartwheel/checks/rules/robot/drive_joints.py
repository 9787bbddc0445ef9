"""Joints of driven wheels."""

from __future__ import annotations

from collections.abc import Iterator

from cartwheel.checks import plugin_tags
from cartwheel.checks.rule import rule
from cartwheel.checks.rules.devices.plugin_joints import unknown_joint
from cartwheel.checks.subject import Subject, is_known
from cartwheel.checks.wheels import drives_in
from cartwheel.codes import robot as robot_codes
from cartwheel.dialects.tag_roles import WHEEL_ROLES
from cartwheel.errors import Diagnostic


@rule(robot_codes.DRIVE_JOINT_UNKNOWN)
def drive_joint_unknown(subject: Subject) -> Iterator[Diagnostic]:
    for robot, drive in drives_in(subject):
        tags = plugin_tags.tags_with(drive.tag.filename, *WHEEL_ROLES)
        for element in drive.tag.element.children:
            name = element.text.strip()
            if element.tag not in tags or is_known(name, robot, subject):
                continue
            yield unknown_joint(robot_codes.DRIVE_JOINT_UNKNOWN, robot, element, name)


@rule(robot_codes.DRIVE_JOINT_NOT_CONTINUOUS)
def drive_joint_fixed(subject: Subject) -> Iterator[Diagnostic]:
    for robot, drive in drives_in(subject):
        for name in drive.joints:
            joint = robot.joints.get(name)
            if joint is None or joint.type == "continuous":
                continue
            axis = joint.axis
            if joint.type == "revolute" and axis.lower is None and axis.upper is None:
                continue
            node = robot.joint_node(name)
            limits = (
                f" with limits of {axis.lower:g} and {axis.upper:g} rad"
                if joint.type == "revolute" and axis.lower is not None and axis.upper is not None
                else ""
            )
            yield robot_codes.DRIVE_JOINT_NOT_CONTINUOUS.diagnostic(
                message=f'the driven wheel joint "{name}" has the type {joint.type}{limits}',
                values={"joint": name, "type": joint.type},
                origin=joint.origin,
                # The wheel rolls for many turns before it reaches a limit.
                severity="info" if joint.turns else None,
                instead='type="continuous"',
                place="attribute" if node is not None else "",
                mark=f'type="{joint.type}"',
            )
