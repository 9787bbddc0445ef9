"""Driven joints that do not exist in Gazebo, because what they move has no mass."""

from __future__ import annotations

from collections.abc import Iterator

from cartwheel.codes import robot
from cartwheel.corpus.fall_causes import LEFT_OUT
from cartwheel.corpus.faults import coded
from cartwheel.corpus.movers import moving_plugins
from cartwheel.corpus.verdict import Verdict
from cartwheel.description.kinematics import carried
from cartwheel.description.model import PluginTag, RobotDescription
from cartwheel.errors import Diagnostic


def dropped_joints(
    verdict: Verdict, description: RobotDescription
) -> Iterator[tuple[str, Diagnostic]]:
    """A joint that is driven, or that a plugin that is not supported would drive, but that does not
    exist in Gazebo, because the link that it moves, or one that carries it, has no mass.
    """
    named = {name for tag in moving_plugins(description) for name in _joints(tag, description)}
    for joint, reason in _lost(description).items():
        if joint in verdict.driven or joint in named:
            yield joint, reason
            return


def moves_nothing(reason: Diagnostic | None, description: RobotDescription) -> bool:
    """Whether the joints in the tags of a plugin do not exist in Gazebo, so that it is no loss.

    Args:
        reason: The diagnostic that the plugin is not supported.
        description: The robot.
    """
    name = "" if reason is None else reason.values.get("name", "")
    lost = _lost(description).keys()
    joints = [
        joint
        for tag in description.plugins
        if tag.filename == name
        for joint in _joints(tag, description)
    ]
    return bool(joints) and lost >= set(joints)


def _joints(tag: PluginTag, description: RobotDescription) -> Iterator[str]:
    """The joints that are named in the tags of a plugin."""
    names = {joint.name for joint in description.joints if joint.type != "fixed"}
    for element in tag.element.walk():
        yield from (word for word in element.text.split() if word in names)


def _lost(description: RobotDescription) -> dict[str, Diagnostic]:
    """The movable joints that do not exist in Gazebo, with the reasons."""
    if coded(description.diagnostics, LEFT_OUT) is not None:
        # The missing part may contain the mass.
        return {}
    held = {joint.child for joint in description.joints}
    found: dict[str, Diagnostic] = {}
    for each in description.diagnostics:
        links = each.values.get("links", ())
        if each.code is not robot.INERTIA_MISSING or not isinstance(links, tuple):
            continue
        lost = carried(description.joints, {str(name) for name in links} & held)
        for joint in description.joints:
            if joint.child in lost:
                found.setdefault(joint.name, each)
    return found
