"""Links to which plugins refer as bodies and frames."""

from __future__ import annotations

from collections.abc import Iterator

from cartwheel.checks import nodes, plugin_tags, spelling
from cartwheel.checks.robot import Robot
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.codes import devices as devices_codes
from cartwheel.description.model import Element, PluginTag, Sensor
from cartwheel.dialects.ros_only import unread_tags
from cartwheel.errors import Code, Diagnostic

_OUTER = frozenset({"world", "map", "odom", "earth", ""})
"""Frames that are not links (REP 105)."""


@rule(devices_codes.BODY_UNKNOWN)
def body_unknown(subject: Subject) -> Iterator[Diagnostic]:
    for robot, tag, _ in _plugins(subject):
        links = plugin_tags.links_in(tag.filename)
        for element in tag.element.children:
            name = element.text.strip().lstrip("/")
            if element.tag in links and name and name not in _known(robot):
                yield _unknown(devices_codes.BODY_UNKNOWN, robot, element)


@rule(devices_codes.FRAME_UNKNOWN)
def frame_unknown(subject: Subject) -> Iterator[Diagnostic]:
    if not subject.is_urdf:
        return
    for robot, tag, _ in _plugins(subject):
        frames = plugin_tags.tags_with(tag.filename, "frame")
        frames -= {each.tag for each, _ in unread_tags(robot.description, tag)}
        for element in tag.element.children:
            name = element.text.strip().lstrip("/")
            if element.tag not in frames or name in _OUTER or name in _known(robot):
                continue
            if name.rpartition("/")[2] in _known(robot):
                continue  # the frame may have a prefix
            yield _unknown(devices_codes.FRAME_UNKNOWN, robot, element)


def _unknown(code: Code, robot: Robot, element: Element) -> Diagnostic:
    name = element.text.strip()
    near = spelling.meant(name.lstrip("/"), robot.links)
    return code.diagnostic(
        message=f'<{element.tag}> refers to the link "{name}", which does not exist',
        values={"tag": element.tag, "link": name},
        origin=element.origin,
        instead=nodes.written(element.tag, {}, near) if near else "",
        place="element" if near else "",
        mark=name,
        hint="" if near else spelling.nearest(name, robot.links),
    )


def _known(robot: Robot) -> set[str]:
    names = set(robot.links)
    if robot.root is not None:
        names |= {nodes.name_of(node) for node in nodes.children(robot.root, "link")}
    return names | {name.rpartition("::")[2] for name in names}


def _plugins(subject: Subject) -> Iterator[tuple[Robot, PluginTag, Sensor | None]]:
    for robot in subject.robots:
        for tag, sensor in robot.plugins():
            yield robot, tag, sensor
