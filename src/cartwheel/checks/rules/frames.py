"""Frame and topic names in plugins."""

from __future__ import annotations

import re
from collections.abc import Iterator

from cartwheel.checks import nodes, spelling
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Robot, Subject
from cartwheel.codes import devices as devices_codes
from cartwheel.description.model import Element, PluginTag, Sensor
from cartwheel.errors import Code, Diagnostic

_BODIES = ("bodyName", "body_name")
_FRAMES = ("robotBaseFrame", "robot_base_frame", "frameName", "frame_name")
_OUTER = frozenset({"world", "map", "odom", "earth", ""})
"""Frames that are not links (REP 105)."""

_TOPIC_TAG = re.compile(
    r"(?i:topic(_?name)?$|^(robot)?_?namespace$|^camera_?name$|^service_?name$|^remapping$)"
)
_TOPIC = re.compile(r"[~/]{0,2}([A-Za-z_]\w*(/[A-Za-z_]\w*)*)?/*")
"""Topic names in both ROS versions, without substitutions; a trailing slash is harmless."""

_TOPICS: dict[str, tuple[tuple[str, ...], ...]] = {
    # Tags with the topics that each plugin publishes, in both spellings.
    "diff_drive": (("odometryTopic", "odometry_topic"),),
    "skid_steer_drive": (("odometryTopic", "odometry_topic"),),
    "planar_move": (("odometryTopic", "odometry_topic"),),
    "imu": (("topicName",),),
    "imu_sensor": (("topicName",),),
    "laser": (("topicName",),),
    "gpu_laser": (("topicName",),),
    "block_laser": (("topicName",),),
    "range": (("topicName",),),
    "p3d": (("topicName",),),
    "bumper": (("bumperTopicName", "bumper_topic_name"),),
    "camera": (("imageTopicName",),),
}


@rule(devices_codes.BODY_UNKNOWN)
def body_unknown(subject: Subject) -> Iterator[Diagnostic]:
    for robot, tag, _ in _plugins(subject):
        for element in tag.element.children:
            name = element.text.strip().lstrip("/")
            if element.tag in _BODIES and name and name not in _known(robot):
                yield _unknown(devices_codes.BODY_UNKNOWN, robot, element)


@rule(devices_codes.FRAME_UNKNOWN)
def frame_unknown(subject: Subject) -> Iterator[Diagnostic]:
    if not subject.is_urdf:
        return
    for robot, tag, _ in _plugins(subject):
        for element in tag.element.children:
            name = element.text.strip().lstrip("/")
            if element.tag not in _FRAMES or name in _OUTER or name in _known(robot):
                continue
            if name.rpartition("/")[2] in _known(robot):
                continue  # the frame may have a prefix
            yield _unknown(devices_codes.FRAME_UNKNOWN, robot, element)


@rule(devices_codes.DUPLICATE_TOPIC)
def topic_twice(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        seen: dict[str, tuple[PluginTag, str]] = {}
        for tag, _ in robot.plugins():
            kind = short_name(tag)
            for tags in _TOPICS.get(kind, ()):
                element = next((e for name in tags if (e := tag.element.find(name))), None)
                if element is None or not element.text.strip():
                    continue
                topic = _resolved(tag, element, kind)
                if topic not in seen:
                    seen[topic] = (tag, kind)
                    continue
                other = seen[topic][0]
                new = f"{element.text.strip()}_2"
                yield devices_codes.DUPLICATE_TOPIC.diagnostic(
                    message=f'the plugins "{other.name}" and "{tag.name}" both publish on '
                    f'"{topic}"',
                    values={"plugin": tag.name, "other": other.name, "topic": topic},
                    origin=element.origin,
                    instead=nodes.written(element.tag, {}, new),
                    place="element",
                    mark=element.text.strip(),
                    hint=f"The other plugin is at {other.origin}.",
                )


@rule(devices_codes.TOPIC_INVALID)
def topic_invalid(subject: Subject) -> Iterator[Diagnostic]:
    for _, tag, _sensor in _plugins(subject):
        held = [*tag.element.children]
        if (ros := tag.element.find("ros")) is not None:
            held += ros.children
        for element in held:
            name = element.text.strip()
            if not _TOPIC_TAG.search(element.tag) or not name or element.children:
                continue
            source, arrow, target = name.rpartition(":=")
            if _TOPIC.fullmatch(target.strip()) and (not arrow or source.strip()):
                continue
            if "ros" not in tag.filename and not re.search(r"[\s@]", target.strip()):
                continue  # Gazebo's own transport accepts almost any name.
            good = re.sub(r"[^\w/~]+", "_", target.strip())
            good = re.sub(r"(^|/)(?=\d)", r"\1_", good)
            yield devices_codes.TOPIC_INVALID.diagnostic(
                message=f'<{element.tag}> "{name}" is not a valid ROS name',
                values={"tag": element.tag, "name": name},
                hint="Names may contain letters, digits, _ and /, and no part may begin with a "
                "digit.",
                origin=element.origin,
                instead=nodes.written(element.tag, {}, f"{source}{arrow}{good}"),
                place="element",
                mark=name,
            )


def short_name(tag: PluginTag) -> str:
    """``diff_drive`` for ``libgazebo_ros_diff_drive.so``."""
    stem = tag.filename.rsplit("/", 1)[-1].removeprefix("lib").removesuffix(".so")
    return stem.removeprefix("gazebo_ros_")


def _resolved(tag: PluginTag, element: Element, kind: str) -> str:
    space = next(
        (e.text.strip() for path in ("ros/namespace", "robotNamespace")
         if (e := tag.element.find(path))),
        "",
    )  # fmt: skip
    name = element.text.strip()
    if kind == "camera":
        camera = tag.element.find("cameraName")
        name = f"{camera.text.strip() if camera is not None else tag.name}/{name}"
    if name.startswith("/"):
        return name
    return "/" + "/".join(part.strip("/") for part in (space, name) if part.strip("/"))


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


RULES = (body_unknown, frame_unknown, topic_twice, topic_invalid)
