"""Limits of joints."""

from __future__ import annotations

from collections.abc import Iterator

from cartwheel.checks import edits, nodes
from cartwheel.checks.kinematic_tree import joints_with_types
from cartwheel.checks.resting import initial_positions
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.codes import robot as robot_codes
from cartwheel.description.elements.node import Node
from cartwheel.errors import Diagnostic

_LIMITED = ("revolute", "prismatic")
_OUTSIDE = {"rad": 0.02, "m": 0.002}
"""Distance of 0 from the limits from which it is reported: limits are often rounded."""


@rule(robot_codes.LIMIT_MISSING)
def limit_missing(subject: Subject) -> Iterator[Diagnostic]:
    wheels = {name for robot in subject.robots for drive in robot.drives for name in drive.joints}
    for joint, kind in joints_with_types(subject):
        if kind in _LIMITED and nodes.child(joint, "limit") is None:
            span = "1.5708" if kind == "revolute" else "0.1"
            rolls = kind == "revolute" and nodes.name_of(joint) in wheels
            yield robot_codes.LIMIT_MISSING.diagnostic(
                message=f'the {kind} joint "{nodes.name_of(joint)}" has no <limit>',
                values={"joint": nodes.name_of(joint), "type": kind},
                origin=joint.origin,
                instead='type="continuous"'
                if rolls
                else f'<limit lower="-{span}" upper="{span}" effort="10" velocity="3"/>',
                place="attribute" if rolls else "inside",
                hint='For a wheel that turns without limits, use type="continuous".'
                if rolls
                else 'Set lower and upper to the range of the joint, or use type="continuous" for '
                "no limits."
                if kind == "revolute"
                else "Set lower and upper to the joint's range.",
            )


@rule(robot_codes.LIMIT_INCOMPLETE)
def limit_incomplete(subject: Subject) -> Iterator[Diagnostic]:
    for joint, _ in joints_with_types(subject):
        limit = nodes.child(joint, "limit")
        if limit is None:
            continue
        for what in ("effort", "velocity"):
            if what not in limit.attributes:
                yield robot_codes.LIMIT_INCOMPLETE.diagnostic(
                    message=f'the <limit> of joint "{nodes.name_of(joint)}" has no {what}',
                    values={"joint": nodes.name_of(joint), "attribute": what},
                    **edits.attribute(limit, what, "10", mark=""),
                )


@rule(robot_codes.LIMIT_REVERSED)
def limit_reversed(subject: Subject) -> Iterator[Diagnostic]:
    for joint, limit, lower, upper in _ranges(subject):
        if lower > upper:
            yield robot_codes.LIMIT_REVERSED.diagnostic(
                message=f'the lower limit of joint "{nodes.name_of(joint)}" is {lower:g}, '
                f"which is above the upper limit of {upper:g}",
                values={"joint": nodes.name_of(joint), "lower": lower, "upper": upper},
                **edits.whole(
                    limit,
                    nodes.changed(limit, lower=nodes.short(upper), upper=nodes.short(lower)),
                    mark="lower",
                ),
            )


@rule(robot_codes.LIMIT_ZERO)
def limit_zero(subject: Subject) -> Iterator[Diagnostic]:
    drives = [drive for robot in subject.robots for drive in robot.drives]
    wheels = {name for drive in drives for name in drive.joints}
    yield from _zero_in_sdf(subject, wheels)
    for joint, limit, lower, upper in _ranges(subject):
        # For driven wheels, another rule requires a continuous joint.
        if lower == upper and nodes.name_of(joint) not in wheels:
            stated = "lower" in limit.attributes or "upper" in limit.attributes
            yield robot_codes.LIMIT_ZERO.diagnostic(
                message=f'joint "{nodes.name_of(joint)}" cannot move: both limits are {lower:g}'
                + ("" if stated else ", the default"),
                values={"joint": nodes.name_of(joint), "lower": lower, "upper": upper},
                origin=limit.origin,
                instead='type="continuous"' if not stated and _turns(joint) else "",
                hint='If the joint must not move, use type="fixed".'
                if stated
                else "Set lower and upper to the joint's range.",
                mark="lower" if stated else "",
            )


@rule(robot_codes.START_OUTSIDE_LIMITS)
def start_outside_limits(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        if robot.description.static:
            continue
        stated = initial_positions(robot)
        for joint in robot.description.joints:
            lower, upper = joint.axis.lower, joint.axis.upper
            start = stated.get(joint.name, 0.0)
            if joint.type not in _LIMITED or lower is None or upper is None or lower == upper:
                continue
            way = max(lower - start, start - upper)
            unit = "rad" if joint.type == "revolute" else "m"
            if way > _OUTSIDE[unit]:
                yield robot_codes.START_OUTSIDE_LIMITS.diagnostic(
                    f'joint "{joint.name}" starts at {start:g}, outside its limits of {lower:.4g} '
                    f"and {upper:.4g} {unit}, so it is pushed by {way:.3g} {unit} when the "
                    "simulation starts",
                    values={"joint": joint.name, "start": start, "lower": lower, "upper": upper},
                    origin=joint.origin,
                    hint="Spawn the robot with the joint within its limits.",
                )


def _zero_in_sdf(subject: Subject, wheels: set[str]) -> Iterator[Diagnostic]:
    for joint, axis, lower, upper in ranges_in_sdf(subject):
        if lower == upper and joint not in wheels:
            yield robot_codes.LIMIT_ZERO.diagnostic(
                # Models from before SDF 1.5 use it as a fixed joint, which did not exist then.
                severity="info",
                message=f'joint "{joint}" cannot move: both limits are {lower:g}',
                values={"joint": joint, "lower": lower, "upper": upper},
                origin=axis.origin,
                hint='If the joint must not move, use type="fixed".',
            )


def ranges_in_sdf(subject: Subject) -> Iterator[tuple[str, Node, float, float]]:
    """Name, limit element, lower and upper value of each SDF joint that rotates."""
    if subject.is_urdf:
        return
    for joint in nodes.walk(subject.root):
        if joint.tag != "joint" or nodes.text_of(joint, "type") != "revolute":
            continue
        limit = nodes.child(nodes.child(joint, "axis"), "limit")
        texts = [nodes.child(limit, tag) for tag in ("lower", "upper")]
        lower, upper = (nodes.number(one.text) if one is not None else None for one in texts)
        if limit is not None and lower is not None and upper is not None:
            yield nodes.name_of(joint), limit, lower, upper


def _turns(joint: Node) -> bool:
    return joint.attributes.get("type") == "revolute"


def _ranges(subject: Subject) -> Iterator[tuple[Node, Node, float, float]]:
    for joint, kind in joints_with_types(subject):
        limit = nodes.child(joint, "limit")
        if limit is None or kind not in _LIMITED:
            continue
        lower = nodes.number(limit.attributes.get("lower", "0"))
        upper = nodes.number(limit.attributes.get("upper", "0"))
        if lower is not None and upper is not None:
            yield joint, limit, lower, upper
