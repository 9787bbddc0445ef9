"""Links to which plugins refer as bodies and frames."""

from __future__ import annotations

from collections.abc import Iterator

from cartwheel.checks import nodes, plugin_tags, spelling
from cartwheel.checks.robot import Robot
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.codes import devices as devices_codes
from cartwheel.description.model import Element, PluginTag, Sensor
from cartwheel.dialects.catalogue import short_name
from cartwheel.dialects.ros_only import unread_tags
from cartwheel.errors import Code, Diagnostic

_OUTER = frozenset({"world", "map", "odom", "earth", ""})
"""Frames that are not links (REP 105)."""

_TRANSFORM_TAGS = frozenset(
    {"publishTf", "publish_tf", "publishOdomTF", "publish_odom_tf", "broadcastTF"}
)
"""Tags that turn the transform of an odometry on and off."""
_BY_DEFAULT = frozenset({"gazebo_ros_diff_drive", "gazebo_ros_planar_move"})
"""Plugins that publish it by default, in ROS 1."""
_FOR_ROS_2 = frozenset({"ros", "left_joint", "right_joint"})


@rule(devices_codes.BODY_UNKNOWN)
def body_unknown(subject: Subject) -> Iterator[Diagnostic]:
    for robot, tag, _ in _plugins(subject):
        links = plugin_tags.links_in(tag.filename)
        for element in tag.element.children:
            stated = element.text.strip()
            name = stated.lstrip("/")
            if element.tag in links and name and _known(robot).isdisjoint((stated, name)):
                yield _unknown(devices_codes.BODY_UNKNOWN, robot, element)


@rule(devices_codes.FRAME_UNKNOWN)
def frame_unknown(subject: Subject) -> Iterator[Diagnostic]:
    if not subject.is_urdf:
        return
    for robot, tag, _ in _plugins(subject):
        frames = plugin_tags.tags_with(tag.filename, "frame")
        frames -= {each.tag for each, _ in unread_tags(robot.description, tag)}
        # tf2 removes the slash at the beginning of a frame.
        known = {name.lstrip("/") for name in _known(robot)}
        for element in tag.element.children:
            name = element.text.strip().lstrip("/")
            if element.tag not in frames or name in _OUTER or name in known:
                continue
            if name.rpartition("/")[2] in known:
                continue  # the frame may have a prefix
            yield _unknown(devices_codes.FRAME_UNKNOWN, robot, element)


@rule(devices_codes.ODOMETRY_FRAME_IS_LINK)
def odometry_frame_is_link(subject: Subject) -> Iterator[Diagnostic]:
    if not subject.is_urdf:
        return
    for robot, tag, _ in _plugins(subject):
        if not _publishes_transform(tag):
            continue
        for role in plugin_tags.roles(tag.filename):
            if role.role != "odometry_frame":
                continue
            stated = next(filter(None, map(tag.element.find, role.tags)), None)
            name = str(role.default[0]) if stated is None else stated.text.strip().lstrip("/")
            if name in robot.links and not _floats(robot, name):
                yield devices_codes.ODOMETRY_FRAME_IS_LINK.diagnostic(
                    f'the drive publishes the transform from "{name}" to the robot, but "{name}" '
                    "is a link of the robot, whose transform robot_state_publisher publishes",
                    values={"plugin": tag.filename, "link": name},
                    origin=tag.origin if stated is None else stated.origin,
                    mark=name,
                    hint="Delete this link from the robot, or choose another name for it.",
                )


def _publishes_transform(tag: PluginTag) -> bool:
    """Whether a drive publishes the transform of its odometry, by its tags or by default."""
    stated = [
        each.text.strip().lower() in ("true", "1")
        for each in tag.element.children
        if each.tag in _TRANSFORM_TAGS
    ]
    own = [each for each in tag.element.children if each.tag in _FOR_ROS_2]
    return all(stated) if stated else short_name(tag.filename) in _BY_DEFAULT and not own


def _floats(robot: Robot, name: str) -> bool:
    """Whether a link is connected to the robot only by joints for the motion of a whole robot."""
    joints = [joint for joint in robot.joints.values() if name in (joint.parent, joint.child)]
    return all(joint.type in ("floating", "planar") for joint in joints)


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
