"""Directions of the friction of driven wheels."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from cartwheel.checks.robot import Robot
from cartwheel.checks.rule import rule
from cartwheel.checks.stated_sizes import stated_sizes
from cartwheel.checks.subject import Subject
from cartwheel.checks.wheels import wheel_axis, wheel_links
from cartwheel.codes import robot as robot_codes
from cartwheel.description.model import Collision, Joint, Link
from cartwheel.errors import Diagnostic
from cartwheel.geometry import rotate

_RATIO = 2.0
"""Smallest ratio of the coefficients with which their direction matters."""
_AXIAL = (0.1, 0.95)
"""Components along the axle of the direction of an oblique wheel."""


@rule(robot_codes.WHEEL_FRICTION_OBLIQUE)
def wheel_friction_oblique(subject: Subject) -> Iterator[Diagnostic]:
    sizes = list(stated_sizes(subject))
    # Drives of mecanum and steered wheels also state a wheel base.
    others = {id(one.robot) for one in sizes if one.measure in ("base", "reach")}
    seen: set[tuple[int, str]] = set()
    for one in sizes:
        if one.measure != "apart" or id(one.robot) in others:
            continue
        robot = one.robot
        for joint in (robot.joints[name] for name in (*one.first, *one.second)):
            if (id(robot), joint.name) not in seen and joint.child in robot.placed:
                seen.add((id(robot), joint.name))
                yield from _findings(robot, joint)


def _findings(robot: Robot, joint: Joint) -> Iterator[Diagnostic]:
    """The finding about a wheel, of which several parts may touch the ground."""
    for name in wheel_links(robot, joint):
        link = robot.links[name]
        for collision in link.collisions:
            axial = _axial(robot, joint, link, collision)
            if axial is None:
                continue
            first, second = collision.surface.mu1, collision.surface.mu2
            angle = math.degrees(math.asin(axial))
            yield robot_codes.WHEEL_FRICTION_OBLIQUE.diagnostic(
                message=f'the friction of the wheel "{joint.child}" has the coefficients {first:g} '
                f"and {second:g} at {angle:.0f}° to its rolling direction, so that it also pushes "
                "sideways, like a mecanum wheel",
                values={"joint": joint.name, "link": name, "angle": angle},
                origin=link.origin,
                hint="Remove <fdir1>, or state equal coefficients.",
            )
            return


def _axial(robot: Robot, joint: Joint, link: Link, collision: Collision) -> float | None:
    """The component along the axle of the direction of a wheel's larger coefficient.

    None if the direction is that of the axle or of rolling, or does not turn with the wheel.
    """
    surface = collision.surface
    first, second = surface.mu1, surface.mu2
    if surface.fdir1 is None or surface.fdir1_frame is not None or first is None or second is None:
        return None
    if max(first, second) < _RATIO * min(first, second):
        return None
    direction = np.array(rotate((link.pose @ collision.pose).orientation, surface.fdir1))
    length = float(np.linalg.norm(direction))
    if length == 0.0:
        return None
    axial = abs(float(wheel_axis(robot, joint) @ direction)) / length
    return min(axial, 1.0) if _AXIAL[0] < axial < _AXIAL[1] else None
