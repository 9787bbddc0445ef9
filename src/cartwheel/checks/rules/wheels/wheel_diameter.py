"""Stated radii and diameters of wheels, compared with their geometry."""

from __future__ import annotations

from collections.abc import Iterator

from cartwheel.checks.rule import rule
from cartwheel.checks.stated_sizes import LEAST, Stated, differs, size_mismatch, stated_sizes
from cartwheel.checks.subject import Subject
from cartwheel.checks.wheels import is_across, wheel_radius
from cartwheel.codes import robot as robot_codes
from cartwheel.errors import Diagnostic


@rule(robot_codes.WHEEL_DIAMETER_MISMATCH)
def wheel_diameter(subject: Subject) -> Iterator[Diagnostic]:
    for one in stated_sizes(subject):
        real = wrong_size(one)
        if real is not None:
            wheel = one.robot.joints[one.first[0]]
            slow = "slower" if one.used > real else "faster"
            far = abs(real / one.used - 1) if one.used else 1.0
            yield size_mismatch(
                robot_codes.WHEEL_DIAMETER_MISMATCH,
                one,
                real,
                f'the {one.measure} of the wheel "{wheel.child}" is {real:.4g} m, so the robot '
                f"drives {far:.0%} {slow} than commanded",
            )


def wrong_size(one: Stated) -> float | None:
    """The real radius or diameter of the wheel of a stated size, m.

    None if the stated one is right, or if it is another measure.
    """
    if one.measure not in ("radius", "diameter"):
        return None
    wheel = one.robot.joints[one.first[0]]
    if wheel.child not in one.robot.links or not one.robot.whole(wheel.child):
        return None
    radius = wheel_radius(one.robot, wheel)
    if radius is None or not is_across(one.robot, wheel):
        return None
    real = radius if one.measure == "radius" else 2 * radius
    return real if differs(one.used, real, LEAST / 2) else None
