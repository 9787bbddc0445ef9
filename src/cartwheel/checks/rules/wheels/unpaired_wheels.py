"""Drives with different numbers of left and right wheels."""

from __future__ import annotations

from collections.abc import Iterator

from cartwheel.checks.controller_claims import severity_in, wheel_sides
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.codes import devices
from cartwheel.dialects.catalogue import plugin_named
from cartwheel.errors import Diagnostic


@rule(devices.WHEELS_UNPAIRED)
def wheels_unpaired(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        for drive in robot.drives:
            counts = len(drive.left), len(drive.right)
            if plugin_named(drive.tag.filename) is not None and _differ(*counts):
                yield devices.WHEELS_UNPAIRED.diagnostic(
                    f'"{drive.tag.filename}" has {counts[0]} left and {counts[1]} right wheels',
                    origin=drive.tag.origin,
                    values={"left": counts[0], "right": counts[1]},
                )
    for _, file in subject.control:
        for controller in file.controllers:
            sides = wheel_sides(controller)
            if sides and _differ(len(sides[0]), len(sides[1])):
                left, right = map(len, sides)
                yield devices.WHEELS_UNPAIRED.diagnostic(
                    f'controller "{controller.name}" has {left} left and {right} right wheels, so '
                    "it does not start",
                    severity=severity_in(file),
                    origin=sides[0][0].origin,
                    values={"left": left, "right": right},
                )


def _differ(left: int, right: int) -> bool:
    """Whether both sides have wheels, but different numbers of them."""
    return bool(left and right) and left != right
