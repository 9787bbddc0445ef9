"""Whether the left wheel of a drive is on the left."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Unpack

from cartwheel.checks import controller_claims as claimed
from cartwheel.checks import edits, nodes
from cartwheel.checks.controller_files import Controller, Value
from cartwheel.checks.robot import Drive, Robot
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.checks.wheels import (
    CAMBER,
    axis_senses,
    drives_in,
    faces_backwards,
    faces_sideways,
    gap_between,
    is_legacy,
    placed_pair,
    wheel_middle,
    wheel_pairs,
    wheel_place,
)
from cartwheel.codes import robot as robot_codes
from cartwheel.description.model import Joint
from cartwheel.dialects.classic.drives.diff_drive import LEGACY_SWAPPED
from cartwheel.errors import Diagnostic, Where

_SWAP = "Swap the two names."
_OPPOSITE = 0.9
"""Minimum cosine between opposite directions."""
_BOTH = ", and both axes point to the right"


@rule(robot_codes.WHEELS_SWAPPED)
def wheels_swapped(subject: Subject) -> Iterator[Diagnostic]:
    for robot, drive, left, right in wheel_pairs(subject):
        element = drive.left_tag
        if element is not None:
            swap = edits.whole(element, nodes.written(element.tag, {}, right.name), mark=left.name)
            where: Where = {**swap, "hint": LEGACY_SWAPPED if is_legacy(drive) else _SWAP}
            yield from _judged(robot, left, right, "", **where)
    for robot, drive in drives_in(subject):
        yield from _crossed(robot, drive)
    for robot, controller, sides in controlled(subject):
        name = sides[0][0]
        pair = placed_pair(robot, *(side[0].text.strip() for side in sides))
        if pair is None:
            continue
        left, right = pair
        owner = f'controller "{controller.name}": '
        ways = ways_of(controller)
        yield from _judged(robot, left, right, owner, ways, origin=name.origin, mark=left.name)


def controlled(subject: Subject) -> Iterator[tuple[Robot, Controller, list[list[Value]]]]:
    """The controllers that drive wheels, with the names of the left and of the right ones."""
    for robot, file in subject.control:
        for controller in file.controllers:
            sides = claimed.wheel_sides(controller)
            if sides:
                yield robot, controller, sides


def ways_of(controller: Controller) -> tuple[float, float]:
    """The signs of the multipliers with which a controller turns the wheels of each side."""
    left, right = (
        each.number if each is not None and each.number is not None else 1.0
        for side in ("left", "right")
        for each in (controller.value(f"{side}_wheel_radius_multiplier"),)
    )
    return math.copysign(1.0, left), math.copysign(1.0, right)


def _crossed(robot: Robot, drive: Drive) -> Iterator[Diagnostic]:
    """Pairs of wheels of one drive that are swapped, while its first pair is not, or conversely.

    The wheels of a side then turn against each other when the robot turns.
    """
    if len(drive.left) != len(drive.right):
        return
    names = zip(drive.left, drive.right, strict=True)
    pairs = [pair for each in names if (pair := placed_pair(robot, *each)) is not None]
    gaps = [gap_between(robot, *pair) for pair in pairs]
    for (left, right), gap in zip(pairs[1:], gaps[1:], strict=True):
        (first, _), usual = pairs[0], gaps[0]
        if float(gap @ usual) < -_OPPOSITE * math.hypot(*gap) * math.hypot(*usual):
            yield robot_codes.WHEELS_SWAPPED.diagnostic(
                message=f'the wheel joints "{left.name}" and "{right.name}" are on other sides of '
                f'the robot than "{first.name}" and its opposite, so the wheels of each side turn '
                "against each other when the robot turns",
                values={"left": left.name, "right": right.name, "partly": True},
                hint=_SWAP,
                origin=drive.tag.origin,
                mark=left.name,
            )


def _judged(
    robot: Robot,
    left: Joint,
    right: Joint,
    owner: str,
    ways: tuple[float, float] = (1.0, 1.0),
    **where: Unpack[Where],
) -> Iterator[Diagnostic]:
    why = _swapped(robot, left, right)
    if why:
        where.setdefault("hint", _SWAP)
        consequence = _consequence(robot, left, right, ways)
        if consequence.startswith(_BOTH):
            where["hint"] += " Reverse both axes."
        yield robot_codes.WHEELS_SWAPPED.diagnostic(
            message=f'{owner}the left wheel joint "{left.name}" is to the right of '
            f'"{right.name}", {why}{consequence}',
            values={"left": left.name, "right": right.name},
            **where,
        )


def _consequence(robot: Robot, left: Joint, right: Joint, ways: tuple[float, float]) -> str:
    """How a robot with swapped wheels drives, which depends on the directions of their axes.

    If both wheels turn backwards, the turn is right again. If one does, the robot turns when it
    should drive, which other rules report.
    """
    senses = axis_senses(robot, left, right)
    rolled = [sense * way for sense, way in zip(senses, ways, strict=False)]
    if faces_sideways(gap_between(robot, left, right)) or (rolled and min(rolled) > CAMBER):
        return ", so the robot turns in the wrong direction"
    if not rolled or max(rolled) > -CAMBER:
        return ""
    both = _BOTH if max(senses) < -CAMBER else ""
    return f"{both}, so the robot drives backwards"


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
    faces_backwards_ = reversed_ and faces_backwards(robot, left, right)
    if abs(gap[0]) > 0.1 * abs(gap[1]) or gap[1] >= 0 or faces_backwards_:
        # The wheels are not beside each other, the sides are correct, or the robot faces
        # backwards, but is otherwise correct.
        return ""
    return f"at y = {sides[0]:.3g} m and y = {sides[1]:.3g} m"
