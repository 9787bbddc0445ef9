"""Joint limits and axes."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from cartwheel.checks import nodes
from cartwheel.checks.rule import rule
from cartwheel.checks.rules import units
from cartwheel.checks.subject import Robot, Subject
from cartwheel.codes import robot as robot_codes
from cartwheel.description.node import Node
from cartwheel.errors import Diagnostic

_LIMITED = ("revolute", "prismatic")
_GRAVITY = 9.8
"""m/s²."""
_LEAST_EFFORT = 10.0
_DEGREES = "Are the limits in degrees? URDF and SDF use radians."
_TORQUES = ("wheelTorque", "max_wheel_torque")
_LEAST_DEGREES, _MOST_DEGREES = 30.0, 360.0
_ENDLESS = frozenset({50.0, 100.0, 200.0, 300.0})
"""rad; limits that stand in for unlimited rotation."""


@rule(robot_codes.LIMIT_MISSING)
def limit_missing(subject: Subject) -> Iterator[Diagnostic]:
    wheels = {name for robot in subject.robots for drive in robot.drives for name in drive.joints}
    for joint, kind in _joints(subject):
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
                else 'Set lower and upper to its range, or use type="continuous" for no limits.'
                if kind == "revolute"
                else "Set lower and upper to the joint's range.",
            )


@rule(robot_codes.LIMIT_REVERSED)
def limit_reversed(subject: Subject) -> Iterator[Diagnostic]:
    for joint, limit, lower, upper in _ranges(subject):
        if lower > upper:
            yield robot_codes.LIMIT_REVERSED.diagnostic(
                message=f'the lower limit of joint "{nodes.name_of(joint)}" is {lower:g}, '
                f"which is above the upper limit of {upper:g}",
                values={"joint": nodes.name_of(joint), "lower": lower, "upper": upper},
                origin=limit.origin,
                instead=nodes.changed(limit, lower=nodes.short(upper), upper=nodes.short(lower)),
                place="element",
                mark="lower",
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


@rule(robot_codes.EFFORT_ZERO)
def effort_zero(subject: Subject) -> Iterator[Diagnostic]:
    yield from _torque_zero(subject)
    movers = {name: robot for robot in subject.robots for name in robot.driven}
    for joint, kind in _joints(subject):
        limit = nodes.child(joint, "limit")
        name = nodes.name_of(joint)
        if limit is None or kind in ("fixed", "floating") or name not in movers:
            continue
        slides = kind == "prismatic"
        if nodes.number(limit.attributes.get("effort")) == 0.0:
            usual = _holding(movers[name], name, slides=slides)
            yield robot_codes.EFFORT_ZERO.diagnostic(
                message=f'the effort limit of the driven joint "{name}" is 0, so Gazebo cannot '
                "move the joint",
                values={"joint": name, "attribute": "effort"},
                origin=limit.origin,
                instead=f'effort="{nodes.short(usual)}"',
                place="attribute",
                mark="effort",
                hint="Cartwheel treats 0 as no limit. The suggested limit is twice the effort "
                "required to hold the load. Replace it with the motor's actual limit.",
            )
        if nodes.number(limit.attributes.get("velocity")) == 0.0:
            yield robot_codes.EFFORT_ZERO.diagnostic(
                message=f'the velocity limit of the driven joint "{name}" is 0, so Gazebo cannot '
                "move the joint",
                values={"joint": name, "attribute": "velocity"},
                origin=limit.origin,
                instead=f'velocity="{"1" if slides else "10"}"',
                place="attribute",
                mark="velocity",
                hint="Set the velocity limit to the motor's maximum speed.",
            )


def _torque_zero(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        for drive in robot.drives:
            for element in drive.tag.element.children:
                differential = "gazebo_ros_diff_drive" in drive.tag.filename
                read = _TORQUES if differential else ("torque",)
                if element.tag in read and nodes.number(element.text) == 0.0:
                    yield robot_codes.EFFORT_ZERO.diagnostic(
                        message=f"<{element.tag}> is 0 N m, so the wheels do not move",
                        values={"tag": element.tag, "plugin": drive.tag.name},
                        origin=element.origin,
                        instead=nodes.written(element.tag, {}, "5"),
                        place="element",
                        mark=element.text.strip(),
                        hint=f"Set <{element.tag}> to the motors' maximum torque.",
                    )


def _holding(robot: Robot, name: str, *, slides: bool) -> float:
    """Twice the effort to hold all that a joint carries, fully extended, N or N m; at least 10."""
    joint = robot.joints.get(name)
    if joint is None or joint.child not in robot.links:
        return _LEAST_EFFORT
    here = np.array(robot.links[joint.child].pose.position)
    load = 0.0
    carried, waiting = set[str](), [joint.child]
    while waiting:
        link = robot.links.get(waiting.pop())
        if link is None or link.name in carried:
            continue
        carried.add(link.name)
        waiting += [one.child for one in robot.description.joints if one.parent == link.name]
        if link.inertial is not None:
            centre = (link.pose @ link.inertial.pose).position
            arm = 1.0 if slides else float(np.linalg.norm(np.array(centre) - here))
            load += link.inertial.mass * arm
    return max(_LEAST_EFFORT, float(f"{2 * _GRAVITY * load:.1g}"))


@rule(robot_codes.LIMIT_INCOMPLETE)
def limit_incomplete(subject: Subject) -> Iterator[Diagnostic]:
    for joint, _ in _joints(subject):
        limit = nodes.child(joint, "limit")
        if limit is None:
            continue
        for what in ("effort", "velocity"):
            if what not in limit.attributes:
                yield robot_codes.LIMIT_INCOMPLETE.diagnostic(
                    message=f'the <limit> of joint "{nodes.name_of(joint)}" has no {what}',
                    values={"joint": nodes.name_of(joint), "attribute": what},
                    origin=limit.origin,
                    instead=f'{what}="10"',
                    place="attribute",
                )


@rule(robot_codes.AXIS_ZERO)
def axis_zero(subject: Subject) -> Iterator[Diagnostic]:
    wheels = {name for robot in subject.robots for drive in robot.drives for name in drive.joints}
    for joint, axis, xyz in _axes(subject):
        if math.hypot(*xyz) < 1e-6:
            yield robot_codes.AXIS_ZERO.diagnostic(
                message=f'the axis of joint "{nodes.name_of(joint)}" has length 0',
                values={"joint": nodes.name_of(joint)},
                origin=axis.origin,
                instead='xyz="0 1 0"' if nodes.name_of(joint) in wheels else 'xyz="0 0 1"',
                place="attribute",
                mark="xyz",
            )


@rule(robot_codes.AXIS_NOT_NORMALIZED)
def axis_not_unit(subject: Subject) -> Iterator[Diagnostic]:
    for joint, axis, xyz in _axes(subject):
        length = math.hypot(*xyz)
        # Three digits, as in 0.577, are close enough to a unit vector.
        if length >= 1e-6 and abs(length - 1) > 0.01:
            unit = " ".join(nodes.short(value / length) for value in xyz)
            yield robot_codes.AXIS_NOT_NORMALIZED.diagnostic(
                message=f'the axis of joint "{nodes.name_of(joint)}" has length {length:.3g} '
                "instead of 1",
                values={"joint": nodes.name_of(joint), "length": length},
                origin=axis.origin,
                instead=f'xyz="{unit}"',
                place="attribute",
                mark="xyz",
            )


@rule(robot_codes.LIMIT_IN_DEGREES)
def limit_degrees(subject: Subject) -> Iterator[Diagnostic]:
    yield from _degrees_in_sdf(subject)
    for joint, kind in _joints(subject):
        limit = nodes.child(joint, "limit")
        if limit is None or kind != "revolute":
            continue
        values = {what: nodes.number(limit.attributes.get(what)) for what in ("lower", "upper")}
        stated = [abs(value) for value in values.values() if value]
        if _are_degrees(stated):
            radians = {
                what: nodes.short(math.radians(value)) for what, value in values.items() if value
            }
            yield robot_codes.LIMIT_IN_DEGREES.diagnostic(
                message=f'the limits of joint "{nodes.name_of(joint)}" reach {max(stated):g} '
                f"rad, which is {max(stated) / 2 / math.pi:.3g} turns",
                values={"joint": nodes.name_of(joint), "largest": max(stated)},
                hint=_DEGREES,
                origin=limit.origin,
                instead=nodes.changed(limit, **radians),
                place="element",
                mark="lower" if values["lower"] else "upper",
            )


def _are_degrees(stated: list[float]) -> bool:
    """Whether the nonzero absolute values look like degrees."""
    if not stated or (len(set(stated)) == 1 and stated[0] in _ENDLESS):
        return False
    return _LEAST_DEGREES <= max(stated) <= _MOST_DEGREES and all(
        value % 5 == 0 or units.is_converted(value, 0.1) for value in stated
    )


def _zero_in_sdf(subject: Subject, wheels: set[str]) -> Iterator[Diagnostic]:
    for joint, axis, lower, upper in _ranges_in_sdf(subject):
        if lower == upper and joint not in wheels:
            yield robot_codes.LIMIT_ZERO.diagnostic(
                # Models from before SDF 1.5 use it as a fixed joint, which did not exist then.
                severity="info",
                message=f'joint "{joint}" cannot move: both limits are {lower:g}',
                values={"joint": joint, "lower": lower, "upper": upper},
                origin=axis.origin,
                hint='If the joint must not move, use type="fixed".',
            )


def _degrees_in_sdf(subject: Subject) -> Iterator[Diagnostic]:
    for joint, axis, lower, upper in _ranges_in_sdf(subject):
        stated = [abs(value) for value in (lower, upper) if value]
        if _are_degrees(stated):
            limit = {"lower": math.radians(lower), "upper": math.radians(upper)}
            inner = "".join(f"<{tag}>{nodes.short(value)}</{tag}>" for tag, value in limit.items())
            yield robot_codes.LIMIT_IN_DEGREES.diagnostic(
                message=f'the limits of joint "{joint}" reach {max(stated):g} rad, which is '
                f"{max(stated) / 2 / math.pi:.3g} turns",
                values={"joint": joint, "largest": max(stated)},
                hint=_DEGREES,
                origin=axis.origin,
                instead=nodes.written("limit", {}, inner),
            )


def _ranges_in_sdf(subject: Subject) -> Iterator[tuple[str, Node, float, float]]:
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


def _joints(subject: Subject) -> Iterator[tuple[Node, str]]:
    if subject.is_urdf:
        for node in nodes.children(subject.root, "joint"):
            yield node, nodes.text_of(node, "type")


def _ranges(subject: Subject) -> Iterator[tuple[Node, Node, float, float]]:
    for joint, kind in _joints(subject):
        limit = nodes.child(joint, "limit")
        if limit is None or kind not in _LIMITED:
            continue
        lower = nodes.number(limit.attributes.get("lower", "0"))
        upper = nodes.number(limit.attributes.get("upper", "0"))
        if lower is not None and upper is not None:
            yield joint, limit, lower, upper


def _axes(subject: Subject) -> Iterator[tuple[Node, Node, tuple[float, ...]]]:
    for joint, kind in _joints(subject):
        axis = nodes.child(joint, "axis")
        if axis is None or kind in ("fixed", "floating"):
            continue
        xyz = nodes.numbers(axis.attributes.get("xyz"), 3)
        if xyz is not None:
            yield joint, axis, xyz


RULES = (
    limit_missing,
    limit_incomplete,
    limit_reversed,
    limit_zero,
    limit_degrees,
    effort_zero,
    axis_zero,
    axis_not_unit,
)
