"""Joints that plugins, transmissions, ros2_control and controllers' files name."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from cartwheel.description.check import nodes, spelling
from cartwheel.description.check.finding import Remark
from cartwheel.description.check.rule import rule
from cartwheel.description.check.subject import DRIVE_JOINT_TAGS, Robot, Subject
from cartwheel.description.model import Element, PluginTag, Sensor
from cartwheel.errors import DescriptionError, Origin

_JOINT_TAG = re.compile(r"(.*[a-z_])?([jJ]oints?|_joints?)(_?[nN]ames?)?|joints?|joint[AB]")
_VALUES = re.compile(r"true|false|[-+\d.eE]+", re.IGNORECASE)
_INTERFACES = tuple(
    f"{space}{kind}"
    for space in ("hardware_interface/", "")
    for kind in (
        "EffortJointInterface", "VelocityJointInterface", "PositionJointInterface",
        "JointStateInterface", "PosVelJointInterface",
    )
)  # fmt: skip
_COMMANDS = ("position", "velocity", "effort", "acceleration")
_JOINT_KEY = re.compile(r"(.*_)?joints?(_names?)?|.*wheels?_names?")
_MAX_YAML = 1_000_000
"""Bytes of a file of controllers."""


@rule("plugin-joint-unknown", "error", "a plugin names a joint that does not exist")
def plugin_joint_unknown(subject: Subject) -> Iterator[Remark]:
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
                    if not name or _VALUES.fullmatch(name) or _is_known(name, robot, subject):
                        continue
                    near = spelling.meant(name, robot.joint_names)
                    text = " ".join(element.text.split()).replace(name, near or name)
                    yield Remark(
                        # What another plugin means by its tags is not certain.
                        severity=None if _is_simulated(subject, tag, sensor) else "warning",
                        message=f'<{element.tag}> names "{name}", which is no joint',
                        origin=element.origin,
                        instead=nodes.written(element.tag, dict(element.attributes), text)
                        if near
                        else "",
                        place="element" if near else "",
                        mark=name,
                        hint="" if near else spelling.nearest(name, robot.joint_names),
                    )


@rule("transmission-joint-unknown", "error", "a transmission is of a joint that does not exist")
def transmission_joint_unknown(subject: Subject) -> Iterator[Remark]:
    for robot, joint in _driven_by(subject, "transmission"):
        yield from _joint_named(subject, robot, joint, "the transmission has no joint to move")


@rule("ros2-control-joint-unknown", "warning", "<ros2_control> has a joint that does not exist")
def ros2_control_joint_unknown(subject: Subject) -> Iterator[Remark]:
    for robot, joint in _driven_by(subject, "ros2_control"):
        yield from _joint_named(subject, robot, joint, "Gazebo passes over it")


@rule("interface-unknown", "warning", "a joint's interface is misspelt")
def interface_unknown(subject: Subject) -> Iterator[Remark]:
    for _, joint in _driven_by(subject, "transmission"):
        for element in joint.find_all("hardwareInterface"):
            name = element.text.strip()
            near = spelling.meant(name, _INTERFACES, parts=False)
            if name not in _INTERFACES and near:
                yield Remark(
                    message=f'no controller knows the interface "{name}"',
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
            yield Remark(
                message=f'no controller knows the {element.tag} "{name}"',
                origin=element.origin,
                instead=f'name="{near}"',
                place="attribute",
                mark=name,
            )


@rule("controllers-file", "error", "a file of controllers is missing, or is no YAML")
def controllers_file(subject: Subject) -> Iterator[Remark]:
    for _, element in _files(subject):
        path = _resolved(subject, element)
        if isinstance(path, Remark):
            yield path
        elif isinstance(found := _composed(path), Remark):
            yield found


@rule("controller-joint-unknown", "error", "a controller is of a joint that does not exist")
def controller_joint_unknown(subject: Subject) -> Iterator[Remark]:
    for robot, element in _files(subject):
        path = _resolved(subject, element)
        root = _composed(path) if isinstance(path, Path) else None
        if root is None or isinstance(root, Remark):
            continue
        named = [
            (key, value)
            for key, value in _named_in(root)
            if re.fullmatch(r"[^$/]+", value.value) and not _VALUES.fullmatch(value.value)
        ]
        missing = [one for one in named if not _is_known(one[1].value.strip(), robot, subject)]
        if len(missing) > 1 and len(missing) == len(named):
            yield Remark(
                severity="warning",
                message=f"none of the {len(named)} joints of these controllers is one of the "
                f'robot\'s: "{named[0][1].value}" and so on',
                origin=element.origin,
                mark=element.text.strip(),
                hint=spelling.nearest(named[0][1].value, robot.joint_names),
            )
            continue
        for key, value in missing:
            name = value.value.strip()
            near = spelling.meant(name, robot.joint_names)
            yield Remark(
                message=f'the controllers\' "{key}" names "{name}", which is no joint',
                origin=Origin(file=str(path), line=value.start_mark.line + 1),
                instead=near,
                mark=name,
                hint="" if near else spelling.nearest(name, robot.joint_names),
            )


def _is_simulated(subject: Subject, tag: PluginTag, sensor: Sensor | None) -> bool:
    return subject.plugins is None or subject.plugins.judge(tag, sensor) is not None


def _joint_named(
    subject: Subject, robot: Robot, joint: Element, consequence: str
) -> Iterator[Remark]:
    name = (joint.attribute("name") or "").strip()
    if not name or _is_known(name, robot, subject):
        return
    yield spelling.misspelt(
        name,
        robot.joint_names,
        attribute="name",
        message=f'there is no joint "{name}": {consequence}',
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


def _files(subject: Subject) -> Iterator[tuple[Robot, Element]]:
    for robot in subject.robots:
        for tag, _ in robot.plugins():
            if "ros2_control" in tag.filename:
                for element in tag.element.find_all("parameters"):
                    if element.text.strip():
                        yield robot, element


def _resolved(subject: Subject, element: Element) -> Path | Remark:
    try:
        return subject.packages.resolve(element.text.strip(), element.origin, what="file")
    except DescriptionError as error:
        return Remark(
            message=f"{error.message}: no controller starts",
            origin=element.origin,
            hint=error.hint or "",
            mark=element.text.strip(),
        )


def _composed(path: Path) -> Any:
    """The file's tree of nodes, which know their lines; a remark where it is no YAML."""
    # Only robots with controllers pay for the import.
    import yaml

    try:
        text = path.read_bytes()[:_MAX_YAML].decode("utf-8", "replace")
        return yaml.compose(text, Loader=yaml.SafeLoader)
    except (OSError, yaml.YAMLError) as error:
        mark = getattr(error, "problem_mark", None)
        problem = getattr(error, "problem", None) or getattr(error, "strerror", None) or error
        return Remark(
            message=f"the file of controllers cannot be read: {problem}",
            origin=Origin(file=str(path), line=mark.line + 1 if mark is not None else 0),
        )


def _named_in(root: Any) -> Iterator[tuple[str, Any]]:
    """Every key that holds joints, with the scalars of its value."""
    waiting: list[Any] = [root]
    while waiting:
        node = waiting.pop()
        if node is None or node.id == "scalar":
            continue
        if node.id == "sequence":
            waiting.extend(node.value)
            continue
        for key, value in node.value:
            held: Sequence[Any] = value.value if value.id == "sequence" else [value]
            if key.id == "scalar" and _JOINT_KEY.fullmatch(key.value):
                yield from ((key.value, one) for one in held if one.id == "scalar")
            waiting.append(value)


def _is_known(name: str, robot: Robot, subject: Subject) -> bool:
    if name in robot.joint_names or name.rpartition("::")[2] in robot.joint_names:
        return True
    return not subject.is_urdf and name.rpartition("::")[2] in subject.joints_written


RULES = (
    plugin_joint_unknown,
    transmission_joint_unknown,
    ros2_control_joint_unknown,
    interface_unknown,
    controllers_file,
    controller_joint_unknown,
)
