"""Wheels without motors that brake a base more than its driven wheels can push it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from cartwheel.checks.controller_claims import base_controllers, wheels_of
from cartwheel.checks.naming import joints_named
from cartwheel.checks.robot import Robot
from cartwheel.checks.rule import rule
from cartwheel.checks.sliding import Braking, braking
from cartwheel.checks.subject import Subject
from cartwheel.codes import robot as robot_codes
from cartwheel.errors import Diagnostic

_FAST = 0.5
"""m/s; a base that is braked above this speed only is not reported."""


class _Driver(NamedTuple):
    text: str
    """A noun phrase."""
    joints: Sequence[str]
    """Those that it turns."""


@rule(robot_codes.WHEELS_BRAKED)
def wheels_braked(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        drivers = _plugins(robot)
        several = len(drivers) > 1
        seen: set[frozenset[str]] = set()
        for driver in (*drivers, *_controllers(subject, robot)):
            wheels = frozenset(driver.joints)
            found = None if wheels in seen else _braked(robot, driver.joints)
            seen.add(wheels)
            if found is not None:
                yield _finding(found, driver, alone=several and driver in drivers)


def _plugins(robot: Robot) -> list[_Driver]:
    """The plugins that drive wheels; none if their wheels together are not braked too much."""
    found = [_Driver(f'plugin "{each.tag.name}"', each.joints) for each in robot.drives]
    every = list(dict.fromkeys(name for each in found for name in each.joints))
    return found if _braked(robot, every) is not None else []


def _controllers(subject: Subject, robot: Robot) -> Iterator[_Driver]:
    """The controllers that drive wheels, of which one drives at a time."""
    for owner, controller in base_controllers(subject):
        if owner is robot:
            yield _Driver(f'controller "{controller.name}"', wheels_of(robot, controller))


def _braked(robot: Robot, names: Sequence[str]) -> Braking | None:
    """How driven wheels are braked; None if they are not, or only at a high speed."""
    found = braking(robot, [robot.joints[name] for name in names if name in robot.joints])
    return None if found is None or found.speed >= _FAST else found


def _finding(found: Braking, driver: _Driver, *, alone: bool) -> Diagnostic:
    said = joints_named([joint.name for joint in found.joints])
    slips = f"slip above {found.speed:.2g} m/s" if found.speed else "slip at any speed"
    return robot_codes.WHEELS_BRAKED.diagnostic(
        message=f"the damping and friction of {said}, which no motor turns, brake the robot: the "
        f"wheels that {driver.text} drives push with at most {found.traction:.3g} N"
        f"{' alone' * alone}, so they {slips}",
        values={"joint": found.joints[0].name, "speed": found.speed, "traction": found.traction},
        origin=found.joints[0].origin,
        hint="Decrease the damping and friction of these joints, increase the friction "
        "coefficients of the driven wheels, or drive all wheels.",
    )
