"""Stated wheel sizes compared with the joints and wheels."""

from __future__ import annotations

from collections.abc import Iterator

from cartwheel.checks import nodes
from cartwheel.checks.rule import rule
from cartwheel.checks.rules.drive import is_across, wheel_middle, wheel_place, wheel_radius
from cartwheel.checks.rules.units import FARTHEST
from cartwheel.checks.subject import Robot, Subject
from cartwheel.checks.wheel_stated import Stated, stated
from cartwheel.codes import robot as robot_codes
from cartwheel.errors import Code, Diagnostic

TOLERANCE = 0.02
"""Relative tolerance for tyre compression and rounded numbers."""
_LEAST = 0.001
"""Minimum difference in a distance, m; half of it for a wheel."""
WIDEST_SKID = 2.5
"""Maximum ratio of the stated wheel separation to the track of a skid-steered robot.

Skid-steered robots need a larger value for correct odometry. This limit applies to robots that are
not longer than wide; see `_widest`.
"""


@rule(robot_codes.WHEEL_SEPARATION_MISMATCH)
def wheel_separation(subject: Subject) -> Iterator[Diagnostic]:
    for one in stated(subject):
        if one.measure not in ("apart", "reach"):
            continue
        apart, joints = (_mean_between(one, 1, middles=middles) for middles in (True, False))
        if one.measure == "reach":
            apart, joints = ((each + _mean_between(one, 0)) / 2 for each in (apart, joints))
        if one.skids and min(apart, joints) <= one.value <= _widest(one, apart):
            continue
        # A wheel may be offset from its joint; either distance is accepted.
        if _differs(one.value, apart, _LEAST) and _differs(one.value, joints, _LEAST):
            more = "more" if one.value > apart else "less"
            said = (
                "the wheels are"
                if one.measure == "apart"
                else "half the sum of wheel base and track is"
            )
            yield _differing(
                robot_codes.WHEEL_SEPARATION_MISMATCH,
                one,
                apart,
                f"{said} {apart:.4g} m{' apart' * (one.measure == 'apart')}, so the robot turns "
                f"{abs(one.value / apart - 1):.0%} {more} than commanded",
            )


@rule(robot_codes.WHEEL_BASE_MISMATCH)
def wheel_base(subject: Subject) -> Iterator[Diagnostic]:
    for one in stated(subject):
        if one.measure == "base":
            apart = _mean_between(one, 0)
            if _differs(one.value, apart, _LEAST):
                more = "more" if one.value > apart else "less"
                yield _differing(
                    robot_codes.WHEEL_BASE_MISMATCH,
                    one,
                    apart,
                    f"the axles are {apart:.4g} m apart, so the robot turns "
                    f"{abs(one.value / apart - 1):.0%} {more} than commanded",
                )


@rule(robot_codes.WHEEL_DIAMETER_MISMATCH)
def wheel_diameter(subject: Subject) -> Iterator[Diagnostic]:
    for one in stated(subject):
        if one.measure not in ("radius", "diameter"):
            continue
        wheel = one.robot.joints[one.first[0]]
        if wheel.child not in one.robot.links or not one.robot.whole(wheel.child):
            continue
        radius = wheel_radius(one.robot, wheel)
        if radius is None or not is_across(one.robot, wheel):
            continue
        real = radius if one.measure == "radius" else 2 * radius
        if _differs(one.value, real, _LEAST / 2):
            slow = "slower" if one.value > real else "faster"
            far = abs(real / one.value - 1) if one.value else 1.0
            yield _differing(
                robot_codes.WHEEL_DIAMETER_MISMATCH,
                one,
                real,
                f'the {one.measure} of the wheel "{wheel.child}" is {real:.4g} m, so the robot '
                f"drives {far:.0%} {slow} than commanded",
            )


def _differing(code: Code, one: Stated, real: float, why: str) -> Diagnostic:
    stated = f"{one.label} is {one.value:g} m"
    if not one.written:
        stated = f"{one.label} is missing and defaults to {one.value:g} m"
    return code.diagnostic(
        message=f"{stated}, but {why}",
        values={
            "tag": one.label,
            "joint": one.first[0],
            "stated": one.value,
            "measured": real,
        },
        origin=one.origin,
        instead=one.write(nodes.short(round(real, 4))),
        place=one.place,
        mark=one.mark,
    )


def _differs(value: float, real: float, least: float) -> bool:
    return 0 < real < FARTHEST and abs(value - real) > max(TOLERANCE * real, least)


def _widest(one: Stated, track: float) -> float:
    """Largest plausible wheel separation for a skid-steered robot, m.

    Consider four wheels of a robot with track t and wheelbase b that turns on the spot at 1 rad/s,
    with rim speed u. Each wheel slides by t/2 - u lengthwise and b/2 sideways. The friction torque
    vanishes where t/2 (t/2 - u) + b/2 b/2 = 0, so that 2 u = t (1 + (b/t)²). This is 2 t for a
    square robot. The limit for longer robots grows by the same ratio beyond `WIDEST_SKID`.
    """
    along = [
        wheel_place(one.robot, joint).position[0]
        for name in one.first + one.second
        if (joint := one.robot.joints[name]).child in one.robot.placed
    ]
    if not along or track <= 0:
        return 0.0
    base = max(along) - min(along)
    return WIDEST_SKID * track * max(1.0, (1 + (base / track) ** 2) / 2)


def _mean_between(one: Stated, axis: int, *, middles: bool = False) -> float:
    """Distance between the means of two sets of joints or wheels along a robot axis, m."""
    first, second = (_mean(one.robot, names, axis, middles) for names in (one.first, one.second))
    return 0.0 if first is None or second is None else abs(first - second)


def _mean(robot: Robot, names: tuple[str, ...], axis: int, middles: bool) -> float | None:
    places = [
        (wheel_middle(robot, joint) if middles else wheel_place(robot, joint).position)[axis]
        for name in names
        if (joint := robot.joints[name]).child in robot.placed
    ]
    return sum(places) / len(places) if places else None


RULES = (wheel_separation, wheel_base, wheel_diameter)
