"""Whether the left wheel of a drive is on the left."""

from __future__ import annotations

from collections.abc import Iterator

from cartwheel.checks import nodes
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.checks.wheels import CAMBER, axis_senses, wheel_pairs, wheel_place
from cartwheel.codes import robot as robot_codes
from cartwheel.errors import Diagnostic


@rule(robot_codes.WHEELS_SWAPPED)
def wheels_swapped(subject: Subject) -> Iterator[Diagnostic]:
    for robot, drive, left, right in wheel_pairs(subject):
        poses = [wheel_place(robot, joint) for joint in (left, right)]
        element = drive.left_tag
        across = poses[0].y - poses[1].y
        # Left and right are known only if the wheels are beside each other, with x forward.
        if element is None or abs(poses[0].x - poses[1].x) > 0.1 * abs(across) or across >= 0:
            continue
        if all(sense < -CAMBER for sense in axis_senses(robot, left, right)):
            continue  # the robot faces backwards, but is otherwise correct
        yield robot_codes.WHEELS_SWAPPED.diagnostic(
            message=f'the left wheel joint "{left.name}" is at y = {poses[0].y:.3g} m, to the '
            f'right of "{right.name}" at y = {poses[1].y:.3g} m',
            values={"left": left.name, "right": right.name},
            origin=element.origin,
            instead=nodes.written(element.tag, {}, right.name),
            place="element",
            mark=left.name,
            hint="Swap the two names. Otherwise, the robot turns in the wrong direction.",
        )
