"""Proportional gains, compared with the friction of their joints and the weight on them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from cartwheel.checks.robot import Robot
from cartwheel.checks.wheels import wheel_axis
from cartwheel.codes.devices import CONTROLLER_GAIN_TOO_LOW
from cartwheel.description.model import Joint
from cartwheel.errors import Diagnostic, Origin

ANGLE, LENGTH = 0.2, 0.02
"""Distance from the target at which a controller should move a joint, rad and m."""
_GRAVITY = 9.8
"""m/s²."""
SLOW = 5.0
"""Time after which an integral counts as too slow, s."""


def gain_too_low(
    robot: Robot, joint: Joint, gain: float, origin: Origin | None, **place: Any
) -> Iterator[Diagnostic]:
    """The findings that a proportional gain is too low for a joint's friction, or for the weight on
    it.

    Args:
        robot: The robot.
        joint: One of its joints.
        gain: N m/rad or N/m.
        origin: Where the gain is stated.
        place: More arguments of the diagnostics.
    """
    yield from _is_stuck(joint, gain, origin, **place)
    yield from _cannot_hold(robot, joint, gain, origin, **place)


def span(joint: Joint) -> float | None:
    """Distance between the limits of a sliding joint, m; None for joints that do not slide."""
    lower, upper = joint.axis.lower, joint.axis.upper
    if joint.type != "prismatic" or lower is None or upper is None or upper <= lower:
        return None
    return upper - lower


def _is_stuck(
    joint: Joint, gain: float, origin: Origin | None, **place: Any
) -> Iterator[Diagnostic]:
    """The finding that a gain does not overcome a joint's friction."""
    slides = joint.type == "prismatic"
    way = LENGTH if slides else ANGLE
    effort, friction = gain * way, joint.axis.friction
    if not 0.0 < effort < friction:
        return
    unit, length = ("N", "m") if slides else ("N m", "rad")
    yield CONTROLLER_GAIN_TOO_LOW.diagnostic(
        f"the proportional gain of {gain:g} {unit}/{length} results in {effort:.3g} {unit} at "
        f"{way:g} {length} from the target, which does not overcome the friction of joint "
        f'"{joint.name}", {friction:g} {unit}',
        values={"joint": joint.name, "gain": gain, "friction": friction},
        origin=origin,
        hint=f"Use a gain well above {friction / way:.3g} {unit}/{length}, or an integral gain.",
        **place,
    )


def _cannot_hold(
    robot: Robot, joint: Joint, gain: float, origin: Origin | None, **place: Any
) -> Iterator[Diagnostic]:
    """The finding that a gain does not hold the weight on a sliding joint."""
    way, weight = span(joint), 0.0
    if way is not None and gain > 0.0 and joint.child in robot.placed:
        upward = abs(float(wheel_axis(robot, joint)[2]))
        weight = _GRAVITY * upward * _mass_on(robot, joint)
    if way is None or gain <= 0.0 or weight / gain <= way:
        return
    yield CONTROLLER_GAIN_TOO_LOW.diagnostic(
        f"the proportional gain of {gain:g} N/m does not hold the weight of {weight:.3g} N on "
        f'joint "{joint.name}": the joint sags by {weight / gain:.3g} m, more than the {way:.3g} m '
        "between its limits, so it stays at a limit",
        values={"joint": joint.name, "gain": gain, "weight": weight},
        origin=origin,
        hint=f"Use a gain well above {weight / way:.3g} N/m, or an integral gain.",
        **place,
    )


def _mass_on(robot: Robot, joint: Joint) -> float:
    """Mass of what a joint carries, kg."""
    below, total, left = robot.inbound, 0.0, [joint.child]
    children: dict[str, list[str]] = {}
    for child, holder in below.items():
        children.setdefault(holder.parent, []).append(child)
    seen = set(left)
    while left:
        name = left.pop()
        link = robot.links.get(name)
        if link is not None and link.inertial is not None and link.gravity:
            total += link.inertial.mass
        more = [each for each in children.get(name, []) if each not in seen]
        seen.update(more)
        left += more
    return total
