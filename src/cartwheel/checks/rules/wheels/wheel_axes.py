"""Directions of the axes of driven and steered wheels."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from cartwheel.checks import nodes, plugin_tags
from cartwheel.checks.robot import Robot
from cartwheel.checks.rule import rule
from cartwheel.checks.rules.wheels.wheel_sides import controlled, ways_of
from cartwheel.checks.subject import Subject
from cartwheel.checks.wheels import (
    CAMBER,
    axis_senses,
    axle_toward_left,
    faces_backwards,
    gap_between,
    placed_pair,
    unsteered_wheels,
    wheel_axis,
    wheel_pairs,
    wheel_place,
)
from cartwheel.codes import robot as robot_codes
from cartwheel.description.model import Joint, PluginTag
from cartwheel.description.rolling import rolling
from cartwheel.description.solids import Floats
from cartwheel.dialects.catalogue import plugin_named
from cartwheel.dialects.gz.mecanum import GzMecanumDrive, MecanumParameters
from cartwheel.dialects.tags import read
from cartwheel.errors import Diagnostic, PluginError
from cartwheel.geometry import matrix_from_quat

_DOWN = -0.5
"""Cosine of the angle between a steering axis and the vertical."""
_TOE, _CROOKED = 0.004, 0.2
"""rad; smallest mean angle of wheels that is reported, and largest angle that is not intended."""


@rule(robot_codes.WHEEL_AXIS_MISALIGNED)
def wheel_axes(subject: Subject) -> Iterator[Diagnostic]:
    yield from _mecanum(subject)
    reported: set[str] = set()
    for robot, drive, left, right in wheel_pairs(subject):
        every = _are_reversed(robot, drive.left, drive.right)
        yield from _of_pair(robot, left, right, reported, every=every)
    for robot, controller, sides in controlled(subject):
        lefts, rights = ([each.text.strip() for each in side] for side in sides)
        if len(lefts) != len(rights):
            continue
        ways = ways_of(controller)
        every = _are_reversed(robot, lefts, rights)
        for names in zip(lefts, rights, strict=True):
            if (pair := placed_pair(robot, *names)) is not None:
                yield from _of_pair(robot, *pair, reported, ways=ways, every=every)


def _of_pair(
    robot: Robot,
    left: Joint,
    right: Joint,
    reported: set[str],
    *,
    ways: tuple[float, float] = (1.0, 1.0),
    every: bool,
) -> Iterator[Diagnostic]:
    """The diagnostics for a pair of wheels.

    Args:
        robot: The robot.
        left: Joint of the left wheel.
        right: Joint of the right wheel.
        reported: The joints about which there is a diagnostic, to which this adds.
        ways: The signs with which the commands of the wheels are multiplied.
        every: Whether the axes of all wheels of the drive point to the right.
    """
    senses = axis_senses(robot, left, right)
    toward_left = axle_toward_left(robot, left, right)
    if toward_left is None:
        return
    both = all(sense * way < -CAMBER for sense, way in zip(senses, ways, strict=True))
    if both and faces_backwards(robot, left, right):
        return
    for joint, sense, way, other in zip((left, right), senses, ways, reversed(senses), strict=True):
        if joint.name in reported:
            continue
        if sense > -CAMBER:
            axis = nodes.child(robot.joint_node(joint.name), "axis")
            stated = nodes.numbers(nodes.text_of(axis, "xyz"), 3)
            turns = joint.type != "fixed" and (stated is None or any(stated))
            if sense < CAMBER and turns:
                reported.add(joint.name)
                yield _not_across(robot, joint, toward_left)
        elif way > 0:
            reported.add(joint.name)
            more = " and the other wheel's axis to the left" if other > CAMBER else ""
            yield _backwards(robot, joint, more, every=both and every)


def _are_reversed(robot: Robot, left: Sequence[str], right: Sequence[str]) -> bool:
    """Whether the axes of all wheels of a drive point to the right of the robot."""
    pairs = [placed_pair(robot, *names) for names in zip(left, right, strict=False)]
    senses = [axis_senses(robot, *pair) for pair in pairs if pair is not None]
    return all(each and max(each) < -CAMBER for each in senses)


def _backwards(robot: Robot, joint: Joint, more: str, *, every: bool = False) -> Diagnostic:
    """The diagnostic for a wheel whose axis points to the right, like `every` one or not."""
    node = nodes.child(robot.joint_node(joint.name), "axis")
    xyz = " ".join(nodes.short(-value + 0.0) for value in joint.axis.xyz)
    return robot_codes.WHEEL_AXIS_MISALIGNED.diagnostic(
        message=f'the wheel of joint "{joint.name}" turns backwards because its axis points to the '
        f"right of the robot{more}",
        values={"joint": joint.name, "attribute": "backwards", "all": every},
        origin=node.origin if node is not None else joint.origin,
        instead=f'xyz="{xyz}"' if node is not None else "",
        place="attribute" if node is not None else "",
        mark="xyz",
    )


def _mecanum(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        for tag in robot.description.plugins:
            if plugin_named(tag.filename) is not GzMecanumDrive or not robot.is_placed:
                continue
            try:
                config, _ = read(MecanumParameters, tag.element)
            except PluginError:
                continue
            sides = (
                (*config.front_left, *config.back_left),
                (*config.front_right, *config.back_right),
            )
            if not rolling(robot.description, *sides).backward:
                continue
            for name in (*sides[0], *sides[1]):
                if joint := robot.joints.get(name):
                    yield _backwards(robot, joint, "")


def _not_across(robot: Robot, joint: Joint, toward_left: Floats) -> Diagnostic:
    """The diagnostic for a wheel whose axis is not parallel to the axle; the default axis is x."""
    written = robot.joint_node(joint.name)
    node = nodes.child(written, "axis")
    own = matrix_from_quat(wheel_place(robot, joint).orientation).T @ toward_left
    xyz = " ".join(nodes.short(round(float(value), 3) + 0.0) for value in own)
    stated = "" if node is not None or written is None else " (the default)"
    text = f'xyz="{xyz}"'
    return robot_codes.WHEEL_AXIS_MISALIGNED.diagnostic(
        message=f'the wheel of joint "{joint.name}" cannot roll forward because the axis '
        f'"{" ".join(nodes.short(value) for value in joint.axis.xyz)}"{stated} is not '
        "parallel to the axle",
        values={"joint": joint.name, "axis": joint.axis.xyz, "attribute": "askew"},
        origin=node.origin if node is not None else joint.origin,
        instead="" if written is None else text if node is not None else f"<axis {text}/>",
        place="" if written is None else "attribute" if node is not None else "inside",
        mark="xyz" if node is not None else f'name="{joint.name}"',
    )


@rule(robot_codes.STEERING_REVERSED)
def steering_axes(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        steering = _steering(robot)
        behind = _steers_behind(robot, steering)
        for name in steering:
            joint = robot.joints.get(name)
            if joint is None or joint.child not in robot.placed:
                continue
            if wheel_axis(robot, joint)[2] * (-1.0 if behind else 1.0) > _DOWN:
                continue
            node = nodes.child(robot.joint_node(name), "axis")
            xyz = " ".join(nodes.short(-value + 0.0) for value in joint.axis.xyz)
            points = "up, and the joint is behind the fixed axle" if behind else "down"
            yield robot_codes.STEERING_REVERSED.diagnostic(
                message=f'the axis of the steering joint "{name}" points {points}, so the robot '
                "steers to the wrong side",
                values={"joint": name},
                origin=node.origin if node is not None else joint.origin,
                instead=f'xyz="{xyz}"' if node is not None else "",
                place="attribute" if node is not None else "",
                mark="xyz",
            )


def _steers_behind(robot: Robot, steering: Sequence[str]) -> bool:
    """Whether the steered wheels are behind the others, in the direction in which it drives."""
    wheels = unsteered_wheels(robot, steering)
    turned = [
        joint
        for name in steering
        if (joint := robot.joints.get(name)) is not None and joint.child in robot.placed
    ]
    axes = [wheel_axis(robot, each) for each in wheels]
    if not turned or not axes or any(abs(axis[1]) < CAMBER for axis in axes):
        return False
    fixed = [wheel_place(robot, each).position[0] for each in wheels]
    steered = [wheel_place(robot, each).position[0] for each in turned]
    if max(steered) >= min(fixed) and max(fixed) >= min(steered):
        return False  # both axles are steered, or wheels are in the middle
    ahead = min(steered) > max(fixed)
    return ahead if _drives_backward(robot, wheels) else not ahead


def _drives_backward(robot: Robot, wheels: Sequence[Joint]) -> bool:
    """Whether a robot faces along negative x: its driven wheels roll there, and its sides agree."""
    driven = [each for each in wheels if each.name in robot.driven] or wheels
    if any(wheel_axis(robot, each)[1] > -CAMBER for each in driven):
        return False
    pairs = [placed_pair(robot, *names) for names in _left_and_right(robot)]
    gaps = [gap_between(robot, *pair)[1] for pair in pairs if pair is not None]
    return bool(gaps) and all(gap < 0 for gap in gaps)


def _left_and_right(robot: Robot) -> Iterator[tuple[str, str]]:
    """A left and a right joint of each drive, and of each axle that is steered."""
    for drive in robot.drives:
        yield from zip(drive.left[:1], drive.right[:1], strict=False)
    for tag in robot.description.plugins:
        names = _steered_by(tag)
        if len(names) == 2:
            yield names[0], names[1]
    if len(robot.steered) == 2:
        # A controller lists the right one first.
        yield robot.steered[1], robot.steered[0]


@rule(robot_codes.WHEELS_TOED)
def wheels_toed(subject: Subject) -> Iterator[Diagnostic]:
    """Steered wheels that do not point ahead on average, although the steering joints are at 0."""
    for robot in subject.robots:
        angles = {
            joint.name: _toe(robot, joint)
            for name in _steering(robot)
            for joint in _held(robot, name)
        }
        toes = {name: angle for name, angle in angles.items() if abs(angle) < _CROOKED}
        if not toes or len(toes) < len(angles):
            continue
        mean = sum(toes.values()) / len(toes)
        if abs(mean) < _TOE:
            continue
        name = max(toes, key=lambda name: abs(toes[name]))
        side = "left" if mean > 0 else "right"
        yield robot_codes.WHEELS_TOED.diagnostic(
            message=f"with the steering joints at 0, the steered wheels point {_degrees(mean)} to "
            f'the {side} on average, because the axis of "{name}" is turned by '
            f"{_degrees(toes[name])}",
            values={"joint": name, "toe": mean},
            origin=robot.joints[name].origin,
            hint="Correct <origin> or <axis> of the joint.",
        )


def _steering(robot: Robot) -> list[str]:
    """The joints that plugins and controllers steer."""
    steered = [name for tag in robot.description.plugins for name in _steered_by(tag)]
    return list(dict.fromkeys([*steered, *robot.steered]))


def _steered_by(tag: PluginTag) -> list[str]:
    """The joints that a plugin steers, the left one first."""
    names = (
        name.strip()
        for each in plugin_tags.roles(tag.filename)
        if each.role == "steering"
        for name in each.joints(tag.element)
    )
    return list(dict.fromkeys(names))


def _held(robot: Robot, steering: str) -> list[Joint]:
    """The wheels' joints that a steering joint carries."""
    joint = robot.joints.get(steering)
    if joint is None or joint.child not in robot.placed:
        return []
    carried = robot.rigid_groups.get(robot.rigid_root(joint.child), [])
    return [
        each
        for each in robot.joints.values()
        if each.turns
        and each.parent in carried
        and each.child in robot.placed
        and abs(wheel_axis(robot, each)[2]) < CAMBER
    ]


def _toe(robot: Robot, joint: Joint) -> float:
    """Angle to the left at which a wheel rolls, rad."""
    x, y, _ = wheel_axis(robot, joint)
    sign = 1.0 if y >= 0 else -1.0
    return math.atan2(-sign * x, sign * y)


def _degrees(angle: float) -> str:
    return f"{abs(math.degrees(angle)):.2g}°"
