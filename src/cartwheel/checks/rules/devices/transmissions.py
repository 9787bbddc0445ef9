"""Joints and interfaces of transmissions and ros2_control."""

from __future__ import annotations

from collections.abc import Iterator

from cartwheel.checks import edits, spelling
from cartwheel.checks.controller_claims import has_standard_hardware, managers
from cartwheel.checks.robot import Robot
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject, is_known
from cartwheel.codes import devices as devices_codes
from cartwheel.description.model import Element
from cartwheel.dialects.catalogue import OF_FETCH, plugin_named
from cartwheel.dialects.ros2_control.unstarted import without_hardware
from cartwheel.dialects.ros_control.interfaces import ros2_control, transmissions
from cartwheel.dialects.stopping import CONSEQUENCE
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
    code = devices_codes.TRANSMISSION_JOINT_UNKNOWN
    for robot in subject.robots:
        notes = _notes(robot, code)
        stopping = {each.origin for each in notes if each.values["stops"] is True}
        for element in robot.description.transmissions:
            for joint in element.find_all("joint"):
                stops = element.origin in stopping
                yield from _joint_named(code, subject, robot, joint, stops=stops)
        yield from (each for each in notes if each.values["joint"] in robot.joint_names)


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
                if plugin_named(tag.filename) is plugin_named(OF_FETCH):
                    # It commands all joints.
                    continue
                inactive = without_hardware(robot.description, tag) if ros2 else None
                yield inactive or devices_codes.CONTROL_WITHOUT_JOINTS.diagnostic(
                    f"{what} a joint, so controllers have no joint to command",
                    origin=tag.origin,
                    values={"plugin": tag.filename},
                )


@rule(devices_codes.INTERFACE_UNKNOWN)
def interface_unknown(subject: Subject) -> Iterator[Diagnostic]:
    code = devices_codes.INTERFACE_UNKNOWN
    stopping = {
        each.origin: each
        for robot in subject.robots
        for each in _notes(robot, code)
        if each.values.get("stops") is True
    }
    for _, joint in _driven_by(subject, "transmission"):
        for element in joint.find_all("hardwareInterface"):
            name = element.text.strip()
            near = spelling.meant(name, _INTERFACES, parts=False)
            stops = stopping.get(element.origin)
            if name not in _INTERFACES and near:
                yield code.diagnostic(
                    message=f'the interface "{name}" does not exist'
                    + (f", {CONSEQUENCE}" if stops is not None else ""),
                    severity=None if stops is None else stops.severity,
                    values={
                        "tag": "hardwareInterface",
                        "interface": name,
                        "meant": near,
                        "stops": stops is not None,
                    },
                    **edits.text(element, near),
                )
            elif stops is not None and stops.values["interface"] == name:
                yield stops
    for _, joint in _driven_by(subject, "ros2_control"):
        for element in joint.children:
            name = (element.attribute("name") or "").strip()
            near = spelling.meant(name, _COMMANDS, parts=False)
            if element.tag not in ("command_interface", "state_interface") or not near:
                continue
            yield code.diagnostic(
                message=f'the {element.tag} "{name}" does not exist',
                values={"tag": element.tag, "interface": name, "meant": near},
                **edits.attribute(element, "name", near, mark=name),
            )


def _notes(robot: Robot, code: Code) -> list[Diagnostic]:
    """The diagnostics with a code that ROS 1's plugin of a robot reports about transmissions."""
    if not managers(robot, ros2=False):
        return []
    several = not has_standard_hardware(robot, ros2=False)
    notes = transmissions(robot.description, several=several)[1]
    return [each for each in notes if each.code is code]


def _joint_named(
    code: Code, subject: Subject, robot: Robot, joint: Element, *, stops: bool = False
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
        message=f'<{what}> refers to the joint "{name}", which does not exist'
        + (f", {CONSEQUENCE}" if stops else ""),
        values={"tag": what, "joint": name, "stops": stops},
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
