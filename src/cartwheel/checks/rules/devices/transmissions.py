"""Joints and interfaces of transmissions and ros2_control."""

from __future__ import annotations

from collections.abc import Iterator

from cartwheel.checks import edits, spelling
from cartwheel.checks.controller_claims import managers
from cartwheel.checks.robot import Robot
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject, is_known
from cartwheel.codes import devices as devices_codes
from cartwheel.description.model import Element
from cartwheel.dialects.ros_control.interfaces import ros2_control, transmissions
from cartwheel.errors import Code, Diagnostic

_INTERFACES = tuple(
    f"{space}{kind}"
    for space in ("hardware_interface/", "")
    for kind in (
        "EffortJointInterface", "VelocityJointInterface", "PositionJointInterface",
        "JointStateInterface", "PosVelJointInterface",
    )
)  # fmt: skip
_COMMANDS = ("position", "velocity", "effort", "acceleration")


@rule(devices_codes.TRANSMISSION_JOINT_UNKNOWN)
def transmission_joint_unknown(subject: Subject) -> Iterator[Diagnostic]:
    for robot, joint in _driven_by(subject, "transmission"):
        yield from _joint_named(devices_codes.TRANSMISSION_JOINT_UNKNOWN, subject, robot, joint)
    for robot in subject.robots:
        if managers(robot, ros2=False):
            notes = transmissions(robot.description)[1]
            yield from (
                each
                for each in notes
                if each.code is devices_codes.TRANSMISSION_JOINT_UNKNOWN
                and each.values.get("joint") in robot.joint_names
            )


@rule(devices_codes.ROS2_CONTROL_JOINT_UNKNOWN)
def ros2_control_joint_unknown(subject: Subject) -> Iterator[Diagnostic]:
    for robot, joint in _driven_by(subject, "ros2_control"):
        yield from _joint_named(devices_codes.ROS2_CONTROL_JOINT_UNKNOWN, subject, robot, joint)


@rule(devices_codes.CONTROL_WITHOUT_JOINTS)
def control_without_joints(subject: Subject) -> Iterator[Diagnostic]:
    if not subject.is_urdf:
        # An SDF model may have the joints in the URDF from which it was made.
        return
    for robot in subject.robots:
        for ros2, what in ((False, "no <transmission> drives"), (True, "no <ros2_control> lists")):
            if ros2:
                joints = ros2_control(robot.description)[0]
            else:
                joints = transmissions(robot.description, several=True)[0]
            for tag in managers(robot, ros2=ros2) if not joints else ():
                yield devices_codes.CONTROL_WITHOUT_JOINTS.diagnostic(
                    f"{what} a joint, so controllers have no joint to command",
                    origin=tag.origin,
                    values={"plugin": tag.filename},
                )


@rule(devices_codes.INTERFACE_UNKNOWN)
def interface_unknown(subject: Subject) -> Iterator[Diagnostic]:
    for _, joint in _driven_by(subject, "transmission"):
        for element in joint.find_all("hardwareInterface"):
            name = element.text.strip()
            near = spelling.meant(name, _INTERFACES, parts=False)
            if name not in _INTERFACES and near:
                yield devices_codes.INTERFACE_UNKNOWN.diagnostic(
                    message=f'the interface "{name}" does not exist',
                    values={"tag": "hardwareInterface", "interface": name, "meant": near},
                    **edits.text(element, near),
                )
    for _, joint in _driven_by(subject, "ros2_control"):
        for element in joint.children:
            name = (element.attribute("name") or "").strip()
            near = spelling.meant(name, _COMMANDS, parts=False)
            if element.tag not in ("command_interface", "state_interface") or not near:
                continue
            yield devices_codes.INTERFACE_UNKNOWN.diagnostic(
                message=f'the {element.tag} "{name}" does not exist',
                values={"tag": element.tag, "interface": name, "meant": near},
                **edits.attribute(element, "name", near, mark=name),
            )


def _joint_named(
    code: Code, subject: Subject, robot: Robot, joint: Element
) -> Iterator[Diagnostic]:
    name = (joint.attribute("name") or "").strip()
    if not name or is_known(name, robot, subject):
        return
    what = "transmission" if code is devices_codes.TRANSMISSION_JOINT_UNKNOWN else "ros2_control"
    yield spelling.misspelt(
        code,
        name,
        robot.joint_names,
        attribute="name",
        message=f'<{what}> refers to the joint "{name}", which does not exist',
        values={"tag": what, "joint": name},
        origin=joint.origin,
        mark=f'name="{joint.attribute("name")}"',
    )


def _driven_by(subject: Subject, what: str) -> Iterator[tuple[Robot, Element]]:
    for robot in subject.robots:
        described = robot.description
        held = described.transmissions if what == "transmission" else described.ros2_control
        for element in held:
            for joint in element.find_all("joint"):
                yield robot, joint
