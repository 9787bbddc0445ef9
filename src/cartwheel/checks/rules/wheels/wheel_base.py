"""Stated wheel bases, compared with the distance between the axles."""

from __future__ import annotations

from collections.abc import Iterator

from cartwheel.checks.rule import rule
from cartwheel.checks.rules.wheels.wheel_diameter import size_mismatch
from cartwheel.checks.stated_sizes import LEAST, differs, mean_between, stated_sizes
from cartwheel.checks.subject import Subject
from cartwheel.codes import robot as robot_codes
from cartwheel.errors import Diagnostic


@rule(robot_codes.WHEEL_BASE_MISMATCH)
def wheel_base(subject: Subject) -> Iterator[Diagnostic]:
    for one in stated_sizes(subject):
        if one.measure == "base":
            apart = mean_between(one, beside=False)
            if differs(one.value, apart, LEAST):
                more = "more" if one.value > apart else "less"
                yield size_mismatch(
                    robot_codes.WHEEL_BASE_MISMATCH,
                    one,
                    apart,
                    f"the axles are {apart:.4g} m apart, so the robot turns "
                    f"{abs(one.value / apart - 1):.0%} {more} than commanded",
                )
