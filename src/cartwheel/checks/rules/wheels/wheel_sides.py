"""Whether the left wheel of a drive is on the left."""

from __future__ import annotations

from collections.abc import Iterator

from cartwheel.checks import controller_claims as claimed
from cartwheel.checks import edits, nodes
from cartwheel.checks.robot import Robot
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.checks.wheels import (
    CAMBER,
    axis_senses,
    faces_sideways,
    gap_between,
    is_legacy,
    wheel_middle,
    wheel_pairs,
    wheel_place,
)
from cartwheel.codes import robot as robot_codes
from cartwheel.description.model import Joint
from cartwheel.errors import Diagnostic

_HINT = "Swap the two names. Otherwise, the robot turns in the wrong direction."


@rule(robot_codes.WHEELS_SWAPPED)
def wheels_swapped(subject: Subject) -> Iterator[Diagnostic]:
    yield from _of_plugins(subject)
    yield from _of_controllers(subject)


def _of_plugins(subject: Subject) -> Iterator[Diagnostic]:
    for robot, drive, left, right in wheel_pairs(subject):
        element = drive.left_tag
        if element is None or is_legacy(drive):
            continue
        why = _swapped(robot, left, right)
        if why:
            yield robot_codes.WHEELS_SWAPPED.diagnostic(
                message=f'the left wheel joint "{left.name}" is to the right of "{right.name}", '
                f"{why}",
                values={"left": left.name, "right": right.name},
                **edits.whole(element, nodes.written(element.tag, {}, right.name), mark=left.name),
                hint=_HINT,
            )


def _of_controllers(subject: Subject) -> Iterator[Diagnostic]:
    for robot, file in subject.control:
        for controller in file.controllers:
            sides = claimed.wheel_sides(controller)
            names = [side[0].text.strip() for side in sides if side]
            left, right = (*(robot.joints.get(name) for name in names), None, None)[:2]
            ends = {left.child, right.child} if left is not None and right is not None else set()
            if left is None or right is None or left is right or not ends <= robot.placed:
                continue
            why = _swapped(robot, left, right)
            if why:
                yield robot_codes.WHEELS_SWAPPED.diagnostic(
                    message=f'controller "{controller.name}": the left wheel joint "{left.name}" '
                    f'is to the right of "{right.name}", {why}',
                    values={"left": left.name, "right": right.name},
                    origin=sides[0][0].origin,
                    mark=left.name,
                    hint=_HINT,
                )


def _swapped(robot: Robot, left: Joint, right: Joint) -> str:
    """Where the left wheel is if it is to the right of the right one, otherwise an empty text."""
    gap = gap_between(robot, left, right)
    sides = [wheel_place(robot, joint).y for joint in (left, right)]
    if (sides[0] - sides[1]) * gap[1] <= 0:
        sides = [wheel_middle(robot, joint)[1] for joint in (left, right)]
    senses = axis_senses(robot, left, right)
    reversed_ = bool(senses) and all(sense < -CAMBER for sense in senses)
    if faces_sideways(gap):
        # Without a known direction of travel, the axes of the wheels define left and right.
        return "as seen in the direction in which the wheels roll" if reversed_ else ""
    if abs(gap[0]) > 0.1 * abs(gap[1]) or gap[1] >= 0 or reversed_:
        # The wheels are not beside each other, the sides are correct, or the robot faces
        # backwards, but is otherwise correct.
        return ""
    return f"at y = {sides[0]:.3g} m and y = {sides[1]:.3g} m"
