"""Files of plugins."""

from __future__ import annotations

import re
from collections.abc import Iterator

from cartwheel.checks import edits, plugin_tags
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.codes import devices as devices_codes
from cartwheel.description.model import WorldDescription
from cartwheel.dialects.catalogue import plugin_named
from cartwheel.dialects.gz.gazebo_only import other_gazebo
from cartwheel.dialects.ros_only import other_ros, other_tags, unread_tags
from cartwheel.dialects.substitutes import substitute
from cartwheel.dialects.world_plugins import misplaced, refused
from cartwheel.errors import Diagnostic
from cartwheel.similar_names import meant_one

_CLASSIC = re.compile(r"(?:lib)?(gazebo_ros_\w+)(?:\.so)?")


@rule(devices_codes.PLUGIN_UNKNOWN)
def plugin_unknown(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        for tag, sensor in robot.plugins():
            if (own := _plain_file(tag.filename)) != tag.filename:
                yield devices_codes.PLUGIN_UNKNOWN.diagnostic(
                    severity="warning",
                    message=f'Gazebo loads the file "{tag.filename}", but the plugin is in "{own}"',
                    values={"plugin": tag.filename, "meant": own},
                    **edits.attribute(tag, "filename", own, mark=tag.filename),
                )
                continue
            if plugin_tags.is_simulated(tag):
                continue
            # Suggest a tag only for misspelt names: other plugins share most of their tags.
            near = meant_one(tag.filename, plugin_tags.filenames(), cutoff=0.92)
            other = None if near else substitute(tag)
            yield devices_codes.PLUGIN_UNKNOWN.diagnostic(
                severity="warning" if near else "info",
                message=f'the plugin "{tag.filename}" does not exist'
                if near
                else f'Cartwheel does not simulate the plugin "{tag.filename}"',
                values={
                    "plugin": tag.filename,
                    "meant": near,
                    "substitute": other.filename if other is not None else "",
                },
                origin=tag.origin,
                hint=other.hint(in_sensor=sensor is not None) if other is not None else "",
                instead=f'filename="{near}"' if near else "",
                place="attribute" if near else "",
                mark=tag.filename,
            )


@rule(devices_codes.PLUGIN_MISPLACED)
def plugin_misplaced(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        for tag, sensor in robot.plugins():
            plugin = plugin_named(tag.filename)
            if (wrong := refused(tag)) is not None:
                yield wrong
            elif plugin is not None and plugin.for_world:
                yield misplaced(tag, "world")
            elif plugin is not None and plugin.for_sensor and sensor is None:
                yield misplaced(tag, "sensor")
    for tag in subject.read.plugins if isinstance(subject.read, WorldDescription) else ():
        plugin = plugin_named(tag.filename)
        if (wrong := refused(tag, in_world=True)) is not None:
            yield wrong
        elif plugin is not None and not (plugin.for_world or plugin.also_in_world):
            yield misplaced(tag, "model")


@rule(devices_codes.PLUGIN_OF_OTHER_ROS)
def plugin_of_other_ros(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        for tag, _ in robot.plugins():
            found = other_ros(robot.description, tag) or other_tags(robot.description, tag)
            if found is not None:
                yield found


@rule(devices_codes.PLUGIN_OF_OTHER_GAZEBO)
def plugin_of_other_gazebo(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        for tag, sensor in robot.plugins():
            found = other_gazebo(robot.description, tag, sensor)
            if found is not None:
                yield found


@rule(devices_codes.PLUGIN_PARAMETER_IGNORED)
def tags_of_ros1(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        for tag, _ in robot.plugins():
            if other_tags(robot.description, tag) is not None:
                continue
            for element, advice in unread_tags(robot.description, tag):
                yield devices_codes.PLUGIN_PARAMETER_IGNORED.diagnostic(
                    f'<{element.tag}> has no effect in Gazebo: the plugin "{tag.filename}" of ROS '
                    "2 reads no tags with capital letters",
                    values={"tag": element.tag, "plugin": tag.filename},
                    origin=element.origin,
                    mark=f"<{element.tag}",
                    hint=advice,
                )


def _plain_file(name: str) -> str:
    """The file name of a Gazebo Classic ROS plugin without its path, as it must be written."""
    match = _CLASSIC.fullmatch(name)
    return name if match is None else f"lib{match[1]}.so"
