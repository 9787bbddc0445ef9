"""Turn rates of skid-steered robots, whose wheels slide when they turn."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from cartwheel.checks.rule import rule
from cartwheel.checks.stated_sizes import Stated, mean_between, stated_sizes
from cartwheel.checks.subject import Subject
from cartwheel.checks.wheels import wheel_middle
from cartwheel.codes import robot as robot_codes
from cartwheel.errors import Diagnostic

_LEAST = 0.05
"""Minimum relative difference between the commanded and the expected turn rate."""
_HALVINGS = 40


@rule(robot_codes.SKID_STEERING)
def skid_steering(subject: Subject) -> Iterator[Diagnostic]:
    sizes = list(stated_sizes(subject))
    # Steered and mecanum wheels, whose drives also state a wheel base, do not slide.
    others = {id(one.robot) for one in sizes if one.measure in ("base", "reach")}
    for one in sizes:
        if one.measure != "apart" or not one.skids or id(one.robot) in others:
            continue
        track = mean_between(one, 1, middles=True)
        places = _places(one)
        if track <= 0 or len(places) < 4 or max(places) - min(places) < 0.01 * track:
            continue
        ratio = one.value / track * turn_ratio(track, places)
        if abs(ratio - 1.0) <= _LEAST:
            continue
        wanted = one.value / ratio
        yield robot_codes.SKID_STEERING.diagnostic(
            message=f"the wheels slide when the robot turns, so it turns at {ratio:.0%} of the "
            "commanded rate",
            values={"tag": one.label, "joint": one.first[0], "ratio": ratio, "stated": one.value},
            origin=one.origin,
            hint=f"A wheel separation of {wanted:.4g} m compensates for this.",
            mark=one.mark,
        )


def turn_ratio(track: float, places: Sequence[float]) -> float:
    """Turn rate of a skid-steered robot, relative to the one at which its wheels would roll.

    All wheels carry the same load, and their friction opposes their sliding velocity. If the wheels
    are driven for a turn rate of 1 rad/s and the robot turns at w, a wheel at x slides by
    (w - 1) t/2 along the robot and by w x across it. The torques of the friction forces balance.
    For four wheels at ±b/2 the result is t² / (t² + b²).

    Args:
        track: Distance between the left and right wheels, m.
        places: Positions of all wheels along the robot, m.
    """
    middle = sum(places) / len(places)
    offsets = [each - middle for each in places]
    half = track / 2
    low, high = 0.0, 1.0
    for _ in range(_HALVINGS):
        turn = (low + high) / 2
        torque = 0.0
        for x in offsets:
            along, across = (turn - 1.0) * half, turn * x
            torque -= (along * half + across * x) / (math.hypot(along, across) or 1.0)
        low, high = (turn, high) if torque > 0 else (low, turn)
    return (low + high) / 2


def _places(one: Stated) -> list[float]:
    """Positions of the wheels along the robot, m."""
    return [
        wheel_middle(one.robot, joint)[0]
        for name in one.first + one.second
        if (joint := one.robot.joints[name]).child in one.robot.placed
    ]
