"""The drive that receives the commands on a topic, and what is found about other drives."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from cartwheel.checks.robot import Robot
from cartwheel.codes import robot, running
from cartwheel.corpus.movers import managers
from cartwheel.description.model import PluginTag, RobotDescription
from cartwheel.dialects.remappings import remap_rules
from cartwheel.errors import Diagnostic

_TOPIC = re.compile(r"^(?:(?:command|cmd)_?(?:vel_?)?(?:ros_?)?)?topic(?:_?name)?$", re.IGNORECASE)
"""Names of the tags of drives with the topic of their commands."""
_COMMANDS = "cmd_vel"
"""The topic of a drive that states none."""
_SIZES = frozenset(
    {
        robot.WHEEL_DIAMETER_MISMATCH,
        robot.WHEEL_SEPARATION_MISMATCH,
        robot.WHEEL_BASE_MISMATCH,
        robot.SKID_STEERING,
    }
)
"""Findings about a size that a drive plugin or a controller states."""


def controller_on(topic: str, controllers: Sequence[str]) -> str:
    """The controller that receives the commands on a topic; empty if it is a plugin."""
    space = topic.rpartition("/")[0].rpartition("/")[2]
    return space if space in controllers else ""


def drives_on(
    fault: Diagnostic, topic: str, description: RobotDescription, controllers: Sequence[str]
) -> bool:
    """Whether a plugin that does not drive would have received the commands on a topic.

    Args:
        fault: The finding that it was left out, or that one of its joints does not exist.
        topic: The topic.
        description: The robot.
        controllers: Names of the robot's controllers, which have topics of their own.
    """
    if controller_on(topic, controllers):
        return False
    name = topic.rpartition("/")[2]
    others = managers(description, jointless=True)
    return any(
        _is_about(fault, tag) and tag not in others and name in _names(tag)
        for tag in description.plugins
    )


def without_other_sizes(
    found: Sequence[Diagnostic],
    topic: str,
    description: RobotDescription,
    controllers: Sequence[str],
) -> list[Diagnostic]:
    """The findings without sizes that other drives state than the one that receives a topic.

    All sizes are left if it is unknown which drive receives it.

    Args:
        found: The findings.
        topic: The topic.
        description: The robot.
        controllers: Names of the robot's controllers, which have topics of their own.
    """
    own, name = controller_on(topic, controllers), topic.rpartition("/")[2]
    places = {
        origin
        for drive in Robot(description, None).drives
        if name in _names(drive.tag)
        for origin in (drive.tag.origin, *(each.origin for each in drive.tag.element.walk()))
    }

    named = {each.values.get("controller") for each in found if each.code in _SIZES}

    def is_own(each: Diagnostic) -> bool:
        controller = each.values.get("controller")
        if not own or controller is None:
            return not own and controller is None and each.origin in places
        # A file that contains a single controller does not state its name.
        return controller == own or (own not in named and controller not in controllers)

    if not own and not places:
        return list(found)
    return [
        each
        for each in found
        if each.code not in _SIZES or "hardware" in each.values or is_own(each)
    ]


def _is_about(fault: Diagnostic, tag: PluginTag) -> bool:
    """Whether a finding is about a plugin."""
    values = fault.values
    if fault.code is running.PLUGIN_LEFT_OUT:
        return tag.filename == values.get("plugin")
    return any(
        each.tag == values.get("tag") and each.text.strip() == values.get("joint")
        for each in tag.element.children
    )


def _names(tag: PluginTag) -> set[str]:
    """The last parts of the names of the topics on which a drive may receive commands."""
    return {each.strip("/").rpartition("/")[2] for each in _topics(tag)}


def _topics(tag: PluginTag) -> Iterator[str]:
    stated = [each.text.strip() for each in tag.element.children if _TOPIC.match(each.tag)]
    yield from stated or [_COMMANDS]
    for source, target in remap_rules(tag):
        if source.rpartition("/")[2] == _COMMANDS:
            yield target
