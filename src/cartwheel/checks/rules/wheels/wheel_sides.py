"""Whether the left wheel of a drive is on the left."""

from __future__ import annotations

from collections.abc import Iterator

from cartwheel.checks import edits, nodes
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
from cartwheel.errors import Diagnostic


@rule(robot_codes.WHEELS_SWAPPED)
def wheels_swapped(subject: Subject) -> Iterator[Diagnostic]:
    for robot, drive, left, right in wheel_pairs(subject):
        element = drive.left_tag
        gap = gap_between(robot, left, right)
        sides = [wheel_place(robot, joint).y for joint in (left, right)]
        if (sides[0] - sides[1]) * gap[1] <= 0:
            sides = [wheel_middle(robot, joint)[1] for joint in (left, right)]
        if element is None or is_legacy(drive):
            continue
        senses = axis_senses(robot, left, right)
        reversed_ = bool(senses) and all(sense < -CAMBER for sense in senses)
        if faces_sideways(gap):
            # Without a known direction of travel, the axes of the wheels define left and right.
            if not reversed_:
                continue
            why = "as seen in the direction in which the wheels roll"
        elif abs(gap[0]) > 0.1 * abs(gap[1]) or gap[1] >= 0 or reversed_:
            # The wheels are not beside each other, the sides are correct, or the robot faces
            # backwards, but is otherwise correct.
            continue
        else:
            why = f"at y = {sides[0]:.3g} m and y = {sides[1]:.3g} m"
        yield robot_codes.WHEELS_SWAPPED.diagnostic(
            message=f'the left wheel joint "{left.name}" is to the right of "{right.name}", {why}',
            values={"left": left.name, "right": right.name},
            **edits.whole(element, nodes.written(element.tag, {}, right.name), mark=left.name),
            hint="Swap the two names. Otherwise, the robot turns in the wrong direction.",
        )
