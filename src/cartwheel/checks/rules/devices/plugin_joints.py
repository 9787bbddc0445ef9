"""Joints to which plugins refer."""

from __future__ import annotations

import re
from collections.abc import Iterator

from cartwheel.checks import nodes, plugin_tags, spelling
from cartwheel.checks.robot import Robot
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject, is_known
from cartwheel.codes import devices as devices_codes
from cartwheel.description.model import Element, PluginTag
from cartwheel.dialects.tag_roles import JOINT_ROLES, WHEEL_ROLES
from cartwheel.errors import Code, Diagnostic, Severity

_JOINT_TAG = re.compile(r"(.*[a-z_])?([jJ]oints?|_joints?)(_?[nN]ames?)?|joints?|joint[AB]")
NOT_A_NAME = re.compile(r"true|false|[-+\d.eE]+", re.IGNORECASE)


@rule(devices_codes.PLUGIN_JOINT_UNKNOWN)
def plugin_joint_unknown(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        drives = {id(drive.tag) for drive in robot.drives}
        for tag, _ in robot.plugins():
            wheels = plugin_tags.tags_with(tag.filename, *WHEEL_ROLES)
            for element in tag.element.children:
                if element.children or not _names_joints(tag, element.tag):
                    continue
                if id(tag) in drives and element.tag in wheels:
                    continue  # another rule's finding
                words = re.split(r"[\s,]+", element.text.strip())
                for name in words:
                    if not name or NOT_A_NAME.fullmatch(name) or is_known(name, robot, subject):
                        continue
                    simulated = plugin_tags.is_simulated(tag)
                    yield unknown_joint(
                        devices_codes.PLUGIN_JOINT_UNKNOWN,
                        robot,
                        element,
                        name,
                        severity=None if simulated else "warning",
                    )


def unknown_joint(
    code: Code, robot: Robot, element: Element, name: str, *, severity: Severity | None = None
) -> Diagnostic:
    """The finding that an element refers to a joint that does not exist."""
    near = spelling.meant(name, robot.joint_names)
    text = " ".join(element.text.split()).replace(name, near)
    return code.diagnostic(
        severity=severity,
        message=f'<{element.tag}> refers to the joint "{name}", which does not exist',
        values={"tag": element.tag, "joint": name},
        origin=element.origin,
        instead=nodes.written(element.tag, dict(element.attributes), text) if near else "",
        place="element" if near else "",
        mark=name,
        hint="" if near else spelling.nearest(name, robot.joint_names),
    )


def _names_joints(tag: PluginTag, name: str) -> bool:
    """Whether a tag names joints: by the plugin's table, or by its name if no plugin reads it."""
    if plugin_tags.is_read(tag.filename, name):
        return name in plugin_tags.tags_with(tag.filename, *JOINT_ROLES)
    return _JOINT_TAG.fullmatch(name) is not None
