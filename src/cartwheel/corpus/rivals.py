"""Whether a robot moves differently if only one of two plugins drives its joints.

Two plugins that drive a joint explain a failure only if the error changes without one of them.
Therefore, the robot is tested again with each of them alone.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

from cartwheel.checks.robot import Drive, Robot
from cartwheel.codes.running import JOINT_DRIVEN_TWICE
from cartwheel.corpus.faults import BASES, Test
from cartwheel.corpus.movers import managers, reports
from cartwheel.corpus.verdict import Verdict
from cartwheel.description.model import Element, PluginTag, RobotDescription
from cartwheel.dialects.catalogue import short_name
from cartwheel.errors import CartwheelError

_MOST = 4
"""Maximum number of plugins that are tested alone."""
_CHANGE = 0.25
"""Smallest change of an error without the other plugin, relative to the error."""
_STIRS = 0.05
"""Smallest change of a base's speed that counts if the speed at least doubles, relative to the
command."""


def hindered(
    verdict: Verdict, robot: RobotDescription, again: Callable[[RobotDescription], Verdict]
) -> frozenset[tuple[Test, str]]:
    """The failed tests, each with its topic or joint, whose error one of two plugins causes.

    Args:
        verdict: The measurements.
        robot: The robot.
        again: Tests a robot.
    """
    contested = {
        str(each.values["joint"])
        for each in verdict.diagnostics
        if each.code is JOINT_DRIVEN_TWICE and "joint" in each.values
    }
    failed = {each: error for each, error, passed in _errors(verdict) if not passed}
    if not contested or not failed:
        return frozenset()
    found: set[tuple[Test, str]] = set()
    for variant in _variants(robot, contested):
        try:
            other = again(variant)
        except CartwheelError:
            continue
        errors = {each: error for each, error, _ in _errors(other)}
        found |= {
            each
            for each, error in failed.items()
            if each in errors and _changes(each[0], errors[each], error)
        }
    return frozenset(found)


def _variants(robot: RobotDescription, joints: set[str]) -> Iterator[RobotDescription]:
    """The robot with one of the plugins that drive these joints, and without their transmissions.

    A drive may steer by controllers of other joints.
    """
    drives = Robot(robot, None).drives
    own = managers(robot)
    drivers = [tag for tag in robot.plugins if tag in own or _drives(tag, drives, joints)]
    if len(drivers) < 2:
        return
    for alone in drivers[:_MOST]:
        plugins = [tag for tag in robot.plugins if tag is alone or tag not in drivers]
        yield replace(robot, plugins=tuple(plugins))
    transmissions = [each for each in robot.transmissions if joints.isdisjoint(_listed(each))]
    if 0 < len(transmissions) < len(robot.transmissions):
        yield replace(robot, transmissions=tuple(transmissions))


def _listed(element: Element) -> list[str]:
    """The joints that a transmission lists."""
    return [(each.attribute("name") or "").strip() for each in element.find_all("joint")]


def _changes(test: Test, alone: float, both: float) -> bool:
    """Whether the error of a failed test is another one without the other plugin.

    A base that stands still because of the other plugin may also have a mistake of its own, such as
    a wrong radius, with which it hardly moves.
    """
    change = abs(alone - both)
    if change >= _CHANGE * abs(both):
        return True
    return test in BASES and change >= _STIRS and abs(1.0 + alone) >= 2.0 * abs(1.0 + both)


def _drives(tag: PluginTag, drives: Sequence[Drive], joints: set[str]) -> bool:
    """Whether a plugin drives one of these joints."""
    named = {word for each in tag.element.walk() for word in each.text.split()}
    for drive in drives:
        if drive.tag is tag:
            named.update(drive.joints)
    return not joints.isdisjoint(named) and not reports(short_name(tag.filename))


def _errors(verdict: Verdict) -> Iterator[tuple[tuple[Test, str], float, bool]]:
    """The tests of motion, with their errors, and whether they passed."""
    for drive in verdict.drives:
        yield ("drive", drive.topic), drive.error, drive.follows
        yield ("turn", drive.topic), drive.error_turn, drive.turns
        yield ("sideways", drive.topic), drive.error_sideways, drive.slides
    for reach in verdict.reaches:
        yield ("reach", reach.joint), reach.error, reach.arrived
    for spin in verdict.spins:
        yield ("spin", spin.joint), spin.measured - spin.commanded, spin.follows
