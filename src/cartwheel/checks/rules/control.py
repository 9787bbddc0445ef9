"""Joint names in plugins, transmissions and ros2_control tags."""

from __future__ import annotations

import re
from collections.abc import Iterator

from cartwheel.checks import nodes, spelling
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import DRIVE_JOINT_TAGS, Robot, Subject
from cartwheel.codes import devices as devices_codes
from cartwheel.description.model import Element, PluginTag, Sensor
from cartwheel.errors import Code, Diagnostic

_JOINT_TAG = re.compile(r"(.*[a-z_])?([jJ]oints?|_joints?)(_?[nN]ames?)?|joints?|joint[AB]")
VALUES = re.compile(r"true|false|[-+\d.eE]+", re.IGNORECASE)
_INTERFACES = tuple(
    f"{space}{kind}"
    for space in ("hardware_interface/", "")
    for kind in (
        "EffortJointInterface", "VelocityJointInterface", "PositionJointInterface",
        "JointStateInterface", "PosVelJointInterface",
    )
)  # fmt: skip
_COMMANDS = ("position", "velocity", "effort", "acceleration")


@rule(devices_codes.PLUGIN_JOINT_UNKNOWN)
def plugin_joint_unknown(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        drives = {id(drive.tag) for drive in robot.drives}
        for tag, sensor in robot.plugins():
            for element in tag.element.children:
                if not _JOINT_TAG.fullmatch(element.tag) or element.children:
                    continue
                if id(tag) in drives and element.tag in DRIVE_JOINT_TAGS:
                    continue
                words = re.split(r"[\s,]+", element.text.strip())
                for name in words:
                    if not name or VALUES.fullmatch(name) or is_known(name, robot, subject):
                        continue
                    near = spelling.meant(name, robot.joint_names)
                    text = " ".join(element.text.split()).replace(name, near or name)
                    yield devices_codes.PLUGIN_JOINT_UNKNOWN.diagnostic(
                        # The tags of unsupported plugins may have a different meaning.
                        severity=None if _is_simulated(subject, tag, sensor) else "warning",
                        message=f'<{element.tag}> refers to the joint "{name}", which does not '
                        "exist",
                        values={"tag": element.tag, "joint": name},
                        origin=element.origin,
                        instead=nodes.written(element.tag, dict(element.attributes), text)
                        if near
                        else "",
                        place="element" if near else "",
                        mark=name,
                        hint="" if near else spelling.nearest(name, robot.joint_names),
                    )


@rule(devices_codes.TRANSMISSION_JOINT_UNKNOWN)
def transmission_joint_unknown(subject: Subject) -> Iterator[Diagnostic]:
    for robot, joint in _driven_by(subject, "transmission"):
        yield from _joint_named(devices_codes.TRANSMISSION_JOINT_UNKNOWN, subject, robot, joint)


@rule(devices_codes.ROS2_CONTROL_JOINT_UNKNOWN)
def ros2_control_joint_unknown(subject: Subject) -> Iterator[Diagnostic]:
    for robot, joint in _driven_by(subject, "ros2_control"):
        yield from _joint_named(devices_codes.ROS2_CONTROL_JOINT_UNKNOWN, subject, robot, joint)


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
                    origin=element.origin,
                    instead=nodes.written("hardwareInterface", {}, near),
                    place="element",
                    mark=name,
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
                origin=element.origin,
                instead=f'name="{near}"',
                place="attribute",
                mark=name,
            )


def _is_simulated(subject: Subject, tag: PluginTag, sensor: Sensor | None) -> bool:
    return subject.plugins is None or subject.plugins.judge(tag, sensor) is not None


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


def is_known(name: str, robot: Robot, subject: Subject) -> bool:
    """Whether a joint with this name exists, with or without its scope."""
    if name in robot.joint_names or name.rpartition("::")[2] in robot.joint_names:
        return True
    if subject.is_urdf:
        return False
    return subject.lacks_models or name.rpartition("::")[2] in subject.joints_written


RULES = (
    plugin_joint_unknown,
    transmission_joint_unknown,
    ros2_control_joint_unknown,
    interface_unknown,
)
