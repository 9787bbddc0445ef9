"""The direction in which a base drives along its wheels, which is not always x."""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterable, Mapping

from cartwheel.checks.robot import Robot
from cartwheel.checks.wheels import (
    CAMBER,
    axis_senses,
    faces_backwards,
    lowest,
    placed_pair,
    wheel_axis,
    wheel_links,
    wheel_place,
)
from cartwheel.description.solids import Floats

FORWARD, BACKWARD = (1.0, 0.0), (-1.0, 0.0)
_ROLLS = 0.2
"""rad/s; minimum speed of a rolling wheel."""
_HORIZONTAL = 0.5
"""Maximum cosine between a wheel's axis and the vertical."""
_PARALLEL = 0.9
"""Minimum length of the mean of the unit axes, as lines, of wheels with a common direction."""
_NEAR = 0.1
"""Maximum height of a wheel above the robot's lowest point, relative to the robot's size: a
spinning lidar is no wheel."""


def heading(robot: Robot, speeds: Mapping[str, float]) -> tuple[float, float]:
    """The direction in which parallel wheels roll, a unit vector in the robot's frame.

    It points toward +x, or toward -x if the robot faces backwards: its left wheels are on the
    right, all axes point to the right, so that it drives backwards and turns as commanded, and a
    camera or steered wheels show that its front is there. For
    wheels with an axis along x, it points away from the side on which the left wheel would be on
    the right, or, if that is unknown, in the direction in which the wheels roll. The driven wheels
    count before those that only roll, such as a caster. Without parallel wheels on the ground it is
    x, as in REP 103.

    Args:
        robot: The robot.
        speeds: Speeds of the joints while the robot drove forward, rad/s, by name.
    """
    rolled = [name for name, speed in speeds.items() if abs(speed) >= _ROLLS]
    driven = {name for sides in robot.sides for side in sides for name in side}
    axle = _axle(_axes(robot, [name for name in rolled if name in driven]))
    axle = axle or _axle(_axes(robot, rolled))
    if axle is None:
        return FORWARD
    forward = (axle[1], -axle[0])
    if abs(forward[0]) > 0.1:
        sign = math.copysign(1.0, -forward[0] if _faces_backwards(robot) else forward[0])
    else:
        sign = _side(robot, forward) or _rolling(robot, speeds, forward)
    return sign * forward[0], sign * forward[1]


def _faces_backwards(robot: Robot) -> bool:
    """Whether the driven wheels show that the robot's front is at -x."""
    pairs = [
        pair
        for left, right in robot.sides
        for names in zip(left, right, strict=False)
        if (pair := placed_pair(robot, *names)) is not None
    ]
    return bool(pairs) and all(
        bool(senses := axis_senses(robot, *pair))
        and max(senses) < -CAMBER
        and faces_backwards(robot, *pair)
        for pair in pairs
    )


def rolling(robot: Robot, names: Iterable[str]) -> dict[str, float]:
    """For each parallel wheel among these joints 1 or -1, so that all roll in one direction.

    Wheels that are mounted in opposite directions slide if they turn at the same speed. The result
    is empty if the wheels are not parallel.
    """
    axes = _axes(robot, names)
    axle = _axle(axes)
    if axle is None:
        return {}
    return {
        name: math.copysign(1.0, axis[0] * axle[0] + axis[1] * axle[1])
        for name, axis in axes.items()
    }


def _axes(robot: Robot, names: Iterable[str]) -> dict[str, Floats]:
    """The horizontal axes of those of the joints whose links are near the ground, as wheels are."""
    turning = [
        robot.joints[name]
        for name in names
        if name in robot.joints
        and robot.joints[name].type in ("continuous", "revolute")
        and robot.joints[name].child in robot.placed
    ]
    ground = lowest(robot, *robot.links) if turning else None
    found = {}
    for joint in turning:
        axis, bottom = wheel_axis(robot, joint), lowest(robot, *wheel_links(robot, joint))
        if bottom is None or ground is None or bottom - ground > _NEAR * robot.size:
            continue
        if abs(axis[2]) <= _HORIZONTAL:
            found[joint.name] = axis
    return found


def _axle(axes: Mapping[str, Floats]) -> tuple[float, float] | None:
    """The direction of parallel axes, a unit vector; None if they are not parallel."""
    # Doubled angles, because an axis and its negative are the same line.
    lines = [cmath.exp(2j * math.atan2(axis[1], axis[0])) for axis in axes.values()]
    mean = sum(lines) / len(lines) if lines else 0.0
    if abs(mean) < _PARALLEL:
        return None
    angle = cmath.phase(mean) / 2
    return math.cos(angle), math.sin(angle)


def _side(robot: Robot, forward: tuple[float, float]) -> float:
    """1 if the left wheels of the drives are to the left of this direction, -1 if they are to the
    right, and 0 if the drives are unknown.
    """
    for wheels in robot.sides:
        sides = [
            [
                wheel_place(robot, robot.joints[name]).position
                for name in side
                if name in robot.joints
            ]
            for side in wheels
        ]
        if not all(sides):
            continue
        (lx, ly), (rx, ry) = (
            (sum(each[0] for each in side) / len(side), sum(each[1] for each in side) / len(side))
            for side in sides
        )
        across = forward[0] * (ly - ry) - forward[1] * (lx - rx)
        if across:
            return math.copysign(1.0, across)
    return 0.0


def _rolling(robot: Robot, speeds: Mapping[str, float], forward: tuple[float, float]) -> float:
    """1 if most wheels roll in this direction on the ground, otherwise -1."""
    rolled = sum(
        math.copysign(1.0, speed * (axis[1] * forward[0] - axis[0] * forward[1]))
        for name, speed in speeds.items()
        if name in robot.joints and robot.joints[name].child in robot.placed
        for axis in [wheel_axis(robot, robot.joints[name])]
    )
    return math.copysign(1.0, rolled)
