"""Wheels without motors that brake a base more than its driven wheels can push it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from cartwheel.checks.controller_claims import base_controllers, wheels_of
from cartwheel.checks.robot import Robot
from cartwheel.checks.rule import rule
from cartwheel.checks.sliding import Braking, braking
from cartwheel.checks.subject import Subject
from cartwheel.checks.wheels import drives_in
from cartwheel.codes import robot as robot_codes
from cartwheel.errors import Diagnostic

_FAST = 0.5
"""m/s; a base that is braked above this speed only is not reported."""


@rule(robot_codes.WHEELS_BRAKED)
def wheels_braked(subject: Subject) -> Iterator[Diagnostic]:
    seen: set[tuple[int, str]] = set()
    for robot, names in _driven(subject):
        found = braking(robot, [robot.joints[name] for name in names if name in robot.joints])
        if found is None or found.speed >= _FAST or (id(robot), found.joints[0].name) in seen:
            continue
        seen.add((id(robot), found.joints[0].name))
        yield _finding(found)


def _driven(subject: Subject) -> Iterator[tuple[Robot, Sequence[str]]]:
    """The joints of each drive and base controller, with its robot."""
    for robot, drive in drives_in(subject):
        yield robot, drive.joints
    for robot, controller in base_controllers(subject):
        yield robot, wheels_of(robot, controller)


def _finding(found: Braking) -> Diagnostic:
    names = [f'"{joint.name}"' for joint in found.joints]
    said = f"joint {names[0]}" if len(names) == 1 else f"joints {', '.join(names)}"
    slips = f"slip above {found.speed:.2g} m/s" if found.speed else "slip at any speed"
    return robot_codes.WHEELS_BRAKED.diagnostic(
        message=f"the damping and friction of {said}, which no motor turns, brake the robot: its "
        f"driven wheels {slips}",
        values={"joint": found.joints[0].name, "speed": found.speed, "traction": found.traction},
        origin=found.joints[0].origin,
        hint="Decrease the damping and friction of these joints, increase the friction "
        "coefficients of the driven wheels, or drive all wheels.",
    )
