"""Limits of joints in degrees."""

from __future__ import annotations

import math
from collections.abc import Iterator

from cartwheel.checks import edits, nodes
from cartwheel.checks.kinematic_tree import joints_with_types
from cartwheel.checks.rule import rule
from cartwheel.checks.rules.robot.joint_limits import ranges_in_sdf
from cartwheel.checks.subject import Subject
from cartwheel.checks.units import is_converted
from cartwheel.codes import robot as robot_codes
from cartwheel.errors import Diagnostic

_DEGREES = "Are the limits in degrees? URDF and SDF use radians."
_LEAST_DEGREES, _MOST_DEGREES = 30.0, 360.0
_ENDLESS = frozenset({50.0, 100.0, 200.0, 300.0})
"""rad; limits that stand in for unlimited rotation."""


@rule(robot_codes.LIMIT_IN_DEGREES)
def limit_degrees(subject: Subject) -> Iterator[Diagnostic]:
    yield from _degrees_in_sdf(subject)
    for joint, kind in joints_with_types(subject):
        limit = nodes.child(joint, "limit")
        if limit is None or kind != "revolute":
            continue
        values = {what: nodes.number(limit.attributes.get(what)) for what in ("lower", "upper")}
        stated = [abs(value) for value in values.values() if value]
        if _are_degrees(stated):
            radians = {
                what: nodes.short(math.radians(value)) for what, value in values.items() if value
            }
            yield robot_codes.LIMIT_IN_DEGREES.diagnostic(
                message=f'the limits of joint "{nodes.name_of(joint)}" reach {max(stated):g} '
                f"rad, which is {max(stated) / 2 / math.pi:.3g} turns",
                values={"joint": nodes.name_of(joint), "largest": max(stated)},
                hint=_DEGREES,
                **edits.whole(
                    limit,
                    nodes.changed(limit, **radians),
                    mark="lower" if values["lower"] else "upper",
                ),
            )


def _are_degrees(stated: list[float]) -> bool:
    """Whether the nonzero absolute values look like degrees."""
    if not stated or (len(set(stated)) == 1 and stated[0] in _ENDLESS):
        return False
    return _LEAST_DEGREES <= max(stated) <= _MOST_DEGREES and all(
        value % 5 == 0 or is_converted(value, 0.1) for value in stated
    )


def _degrees_in_sdf(subject: Subject) -> Iterator[Diagnostic]:
    for joint, axis, lower, upper in ranges_in_sdf(subject):
        stated = [abs(value) for value in (lower, upper) if value]
        if _are_degrees(stated):
            limit = {"lower": math.radians(lower), "upper": math.radians(upper)}
            inner = "".join(f"<{tag}>{nodes.short(value)}</{tag}>" for tag, value in limit.items())
            yield robot_codes.LIMIT_IN_DEGREES.diagnostic(
                message=f'the limits of joint "{joint}" reach {max(stated):g} rad, which is '
                f"{max(stated) / 2 / math.pi:.3g} turns",
                values={"joint": joint, "largest": max(stated)},
                hint=_DEGREES,
                origin=axis.origin,
                instead=nodes.written("limit", {}, inner),
            )
