"""Joints that mimic others beyond their own limits."""

from __future__ import annotations

import math
from collections.abc import Iterator

from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.codes import robot as robot_codes
from cartwheel.description.mimicking import stated_limits, targets
from cartwheel.errors import Diagnostic

_SLACK = 0.02
"""Part of a follower's range by which its target may be outside: limits are often rounded."""
_ENDLESS = 1e4
"""rad or m; limits that no joint reaches, which stand in for none."""


@rule(robot_codes.MIMIC_OUT_OF_LIMITS)
def mimic_limits(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        if robot.description.static:
            continue
        for joint in robot.description.joints:
            mimic = joint.mimic
            limits = stated_limits(joint, follows=True)
            if mimic is None or mimic.mutual or limits is None:
                continue
            if limits[0] <= -_ENDLESS and limits[1] >= _ENDLESS:
                continue
            low, high = targets(mimic, robot.joints, lambda each: each.mimic)
            span = limits[1] - limits[0]
            slack = _SLACK * span if math.isfinite(span) else 0.0
            if low >= limits[0] - slack and high <= limits[1] + slack:
                continue
            bounded = math.isfinite(low) and math.isfinite(high)
            leader = robot.joints.get(mimic.joint)
            if not bounded and (leader is None or leader.type != "continuous"):
                # Its limits are missing, which other rules report.
                continue
            where = f"is between {low:.4g} and {high:.4g}" if bounded else "has no limits"
            yield robot_codes.MIMIC_OUT_OF_LIMITS.diagnostic(
                f'joint "{joint.name}" can follow "{mimic.joint}" only up to its own limits of '
                f"{limits[0]:.4g} and {limits[1]:.4g}: its target, {mimic.multiplier:.4g} times "
                f"the position of the leader plus {mimic.offset:.4g}, {where}",
                origin=joint.origin,
                hint="Change the limits of one of the two joints, or the sign of the multiplier.",
                values={
                    "joint": joint.name,
                    "leader": mimic.joint,
                    "lower": _finite(limits[0]),
                    "upper": _finite(limits[1]),
                    "lowest": _finite(low),
                    "highest": _finite(high),
                },
            )


def _finite(position: float) -> float | None:
    return position if math.isfinite(position) else None
