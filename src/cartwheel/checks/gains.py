"""Proportional gains, compared with the friction of their joints and the weight on them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from cartwheel.checks.resting import starting_poses
from cartwheel.checks.robot import Robot
from cartwheel.checks.wheels import wheel_axis, wheel_place
from cartwheel.codes.devices import CONTROLLER_GAIN_TOO_LOW
from cartwheel.description.model import Joint
from cartwheel.description.solids import Floats
from cartwheel.errors import Diagnostic, Origin

ANGLE, LENGTH = 0.2, 0.02
"""Distance from the target at which a controller should move a joint, rad and m."""
_GRAVITY = 9.8
"""m/s²."""
_UPRIGHT = math.pi / 3
"""Angle from the upright position within which a joint starts that has to hold its load up, rad."""
_HANGING = math.pi / 6
"""Angle from where a load hangs within which gravity acts like a spring, rad."""
_ERROR = 0.5
"""Part of this distance by which a joint may miss its target."""
_LIFTS = 1.0 - _ERROR
"""Smallest part of its target to which a joint has to move."""
_OVERSHOOTS = 1.0 + _ERROR
"""Multiple of its target beyond which a joint does not follow."""
SLOW = 5.0
"""Time after which an integral counts as too slow, s."""


def gain_too_low(
    robot: Robot,
    joint: Joint,
    gain: float,
    origin: Origin | None,
    *,
    integral: float = 0.0,
    of_velocity: bool = False,
    **place: Any,
) -> Iterator[Diagnostic]:
    """The findings that a proportional gain is too low for a joint's friction, or for the weight on
    it.

    An integral overcomes friction and a constant weight, but does not hold up a load above the
    joint: ``J s³ + d s² + (p - C) s + i`` has a root with a positive real part if p is below C.

    Args:
        robot: The robot.
        joint: One of its joints.
        gain: N m/rad or N/m.
        origin: Where the gain is stated.
        integral: The integral gain in N m/(rad s) or N/(m s).
        of_velocity: Whether it is the gain of a velocity, in N m s/rad or N s/m.
        place: More arguments of the diagnostics.
    """
    stated, found = _Stated(joint, gain, origin, place), list[Diagnostic]()
    free = gain > 0.0 and not of_velocity and not joint.axis.spring_stiffness
    weak = integral * SLOW < gain
    if weak:
        found += _is_stuck(stated)
        found += _cannot_hold(robot, stated)
        load = _pendulum(robot, joint) if free else None
        if load is not None:
            found += _hangs(stated, *load)
            found += _drops(stated, *load)
            found += _tips(robot, stated)
    if not of_velocity:
        found += _falls_over(robot, stated)
    if not found and weak and free:
        found += _sags(robot, stated)
    yield from found


def upright_stiffness(robot: Robot, joint: Joint) -> float:
    """The gain below which gravity turns a joint over that starts with its load above it, N m/rad.

    At an angle a from the upright position, gravity's torque is C sin(a), where C is the weight on
    the joint times the distance of its centre of mass from the axis, both perpendicular to the
    axis. It grows faster with the angle than the torque of a proportional gain below C, so that
    the joint has no stable position near the upright one. The other joints are at 0.

    Args:
        robot: The robot.
        joint: One of its joints.

    Returns:
        0 if the joint does not turn, if it starts further than 60° from the upright position, if
        its limits exclude this position, or if its friction or its spring holds the load.
    """
    found = _pendulum(robot, joint)
    if found is None:
        return 0.0
    left, stiffness = found
    lower, upper = joint.axis.lower, joint.axis.upper
    limited = joint.type == "revolute" and lower is not None and upper is not None
    if limited and lower is not None and upper is not None:
        start = min(max(0.0, lower), upper)
        if upper <= lower or not lower <= start + left <= upper:
            return 0.0
    if abs(left) > _UPRIGHT:
        return 0.0
    if joint.axis.friction >= stiffness:
        return 0.0
    return max(0.0, stiffness - joint.axis.spring_stiffness)


def following_gain(robot: Robot, joint: Joint) -> float:
    """The proportional gain below which a joint with its load above it does not follow its targets,
    N m/rad.

    At a small angle a from the upright position, gravity pushes the load further with C a (see
    `upright_stiffness`), so that a gain p holds a target t at t p / (p - C). Friction may let it
    stop earlier, but a joint that swings up to there stays there.

    Args:
        robot: The robot.
        joint: One of its joints.

    Returns:
        At least `upright_stiffness`, which is 0 if the load is not above the joint.
    """
    stiffness = upright_stiffness(robot, joint)
    found = _pendulum(robot, joint)
    if found is None or abs(found[0]) > _HANGING:
        return stiffness
    return stiffness * _OVERSHOOTS / (_OVERSHOOTS - 1.0)


def _pendulum(robot: Robot, joint: Joint) -> tuple[float, float] | None:
    """The way of a joint that turns to the upright position of its load, rad, and the maximum
    torque of gravity, N m. None without a load.
    """
    turns = joint.type in ("revolute", "continuous")
    if not turns or joint.child not in robot.placed or joint.mimic is not None:
        return None
    load = _loads(robot).get(joint.child)
    if load is None or load.mass <= 0.0:
        return None
    axis = wheel_axis(robot, joint)
    arm = load.moment / load.mass - np.array(wheel_place(robot, joint).position)
    arm, up = (each - (each @ axis) * axis for each in (arm, np.array([0.0, 0.0, 1.0])))
    left = math.atan2(float(axis @ np.cross(arm, up)), float(arm @ up))
    return left, float(_GRAVITY * load.mass * np.linalg.norm(arm) * np.linalg.norm(up))


def span(joint: Joint) -> float | None:
    """Distance between the limits of a sliding joint, m; None for joints that do not slide."""
    lower, upper = joint.axis.lower, joint.axis.upper
    if joint.type != "prismatic" or lower is None or upper is None or upper <= lower:
        return None
    return upper - lower


class _Stated(NamedTuple):
    """A proportional gain of a joint, and where it is stated."""

    joint: Joint
    gain: float
    """N m/rad or N/m."""
    origin: Origin | None
    place: Mapping[str, Any]
    """More arguments of the diagnostics."""

    @property
    def units(self) -> tuple[str, str]:
        """The units of the joint's effort and of its position."""
        return ("N", "m") if self.joint.type == "prismatic" else ("N m", "rad")

    def too_low(
        self, why: str, least: float, *, held: bool = False, **values: float
    ) -> Iterator[Diagnostic]:
        """The finding that the gain is too low.

        Args:
            why: What it does not do.
            least: The gain that should be exceeded by far.
            held: Whether an integral gain does not suffice.
            values: More values of the diagnostic.
        """
        effort, length = self.units
        instead = ". An integral gain does not suffice." if held else ", or an integral gain."
        yield CONTROLLER_GAIN_TOO_LOW.diagnostic(
            f"the proportional gain of {self.gain:g} {effort}/{length} {why}",
            values={"joint": self.joint.name, "gain": self.gain, **values},
            origin=self.origin,
            hint=f"Use a gain well above {least:.3g} {effort}/{length}{instead}",
            **self.place,
        )


def _is_stuck(stated: _Stated) -> Iterator[Diagnostic]:
    """The finding that a gain does not overcome a joint's friction."""
    joint = stated.joint
    way = _ERROR * (LENGTH if joint.type == "prismatic" else ANGLE)
    effort, friction = stated.gain * way, joint.axis.friction
    if not 0.0 < effort < friction:
        return
    unit, length = stated.units
    yield from stated.too_low(
        f"results in {effort:.3g} {unit} at {way:g} {length} from the target, which does not "
        f'overcome the friction of joint "{joint.name}", {friction:g} {unit}',
        friction / way,
        friction=friction,
    )


def _cannot_hold(robot: Robot, stated: _Stated) -> Iterator[Diagnostic]:
    """The finding that a gain does not hold the weight on a sliding joint."""
    joint, gain = stated.joint, stated.gain
    way, weight = span(joint), abs(_pull(robot, joint))
    if way is None or gain <= 0.0 or weight / gain <= way:
        return
    yield from stated.too_low(
        f'does not hold the weight of {weight:.3g} N on joint "{joint.name}": the joint sags by '
        f"{weight / gain:.3g} m, more than the {way:.3g} m between its limits, so it stays at a "
        "limit",
        weight / way,
        weight=weight,
    )


def _sags(robot: Robot, stated: _Stated) -> Iterator[Diagnostic]:
    """The finding that a joint sags far from where it starts."""
    joint = stated.joint
    turns = _pendulum(robot, joint)
    if turns is not None:
        left, stiffness = turns
        way, towards, load = _ERROR * ANGLE, -left, stiffness * math.sin(abs(left))
        # Between both angles, gravity's torque is larger than at one of them.
        least = min(load, stiffness * math.sin(abs(left) + way))
    else:
        way, towards = _ERROR * LENGTH, _pull(robot, joint)
        least = load = abs(towards)
    held = stated.gain * way + joint.axis.friction >= least or _room(joint, towards) <= way
    if held or joint.mimic is not None:
        return
    effort, length = stated.units
    yield from stated.too_low(
        f'lets joint "{joint.name}" sag by more than {way:g} {length}: its load is '
        f"{load:.3g} {effort} where it starts",
        load / way,
        load=load,
    )


def _pull(robot: Robot, joint: Joint) -> float:
    """The weight on a sliding joint with limits along its axis, N; negative towards the lower
    limit.
    """
    if span(joint) is None or joint.child not in robot.placed:
        return 0.0
    load = _loads(robot).get(joint.child)
    return -_GRAVITY * float(wheel_axis(robot, joint)[2]) * load.mass if load is not None else 0.0


def _room(joint: Joint, direction: float) -> float:
    """Distance from where a joint starts to its limit in a direction, rad or m."""
    lower, upper = joint.axis.lower, joint.axis.upper
    if joint.type == "continuous" or lower is None or upper is None:
        return math.inf
    start = min(max(0.0, lower), upper)
    return upper - start if direction > 0 else start - lower


def _falls_over(robot: Robot, stated: _Stated) -> Iterator[Diagnostic]:
    """The finding that a gain does not hold up what a joint that turns carries."""
    least = upright_stiffness(robot, stated.joint) if stated.gain > 0.0 else 0.0
    if stated.gain >= least:
        return
    yield from stated.too_low(
        f'does not hold up the load of joint "{stated.joint.name}": near the upright position, '
        f"gravity turns it over with {least:.3g} N m per rad",
        least,
        held=True,
        upright=least,
    )


def _hangs(stated: _Stated, left: float, stiffness: float) -> Iterator[Diagnostic]:
    """The finding that a gain hardly lifts what hangs from a joint; for the load see `_pendulum`.

    At a small angle a from where the load hangs, gravity pulls back with C a, so that the joint
    moves to p / (p + C) of its target.
    """
    part = stated.gain / (stated.gain + stiffness)
    if math.pi - abs(left) > _HANGING or part >= _LIFTS:
        return
    yield from stated.too_low(
        f'hardly lifts what hangs from joint "{stated.joint.name}": gravity pulls it back with '
        f"{stiffness:.3g} N m per rad, so it moves to {100 * part:.2g} % of its target",
        stiffness,
        hanging=stiffness,
    )


def _tips(robot: Robot, stated: _Stated) -> Iterator[Diagnostic]:
    """The finding that a gain holds up a load above its joint, but lets it tip far beyond each
    target.
    """
    joint, gain = stated.joint, stated.gain
    least = upright_stiffness(robot, joint)
    if not least < gain < following_gain(robot, joint):
        return
    yield from stated.too_low(
        f'lets the load above joint "{joint.name}" tip: near the upright position, gravity pushes '
        f"it further with {least:.3g} N m per rad, so it moves to "
        f"{100 * gain / (gain - least):.0f} % of its target",
        least,
        upright=least,
    )


def _drops(stated: _Stated, left: float, stiffness: float) -> Iterator[Diagnostic]:
    """The finding that a joint drops from where it starts, whatever its target.

    There, gravity's torque is larger than that of the gain at a distance of the whole range.
    """
    axis = stated.joint.axis
    if axis.lower is None or axis.upper is None or axis.upper <= axis.lower:
        return
    if abs(left) <= _UPRIGHT or math.pi - abs(left) <= _HANGING:
        # Loads that begin upright or hanging have findings of their own.
        return
    load, most = stiffness * math.sin(abs(left)), stated.gain * (axis.upper - axis.lower)
    if most + axis.friction >= load:
        return
    yield from stated.too_low(
        f'does not hold the load of joint "{stated.joint.name}" where it starts, {load:.3g} N m: '
        f"for targets within the limits, it exerts at most {most:.3g} N m",
        load / ANGLE,
        load=load,
    )


@dataclass(frozen=True, slots=True)
class _Load:
    """What a joint carries, as far as gravity acts on it."""

    mass: float
    """kg."""
    moment: Floats
    """Sum of mass times position at the start, in the model frame, kg m, shape (3,)."""


@lru_cache(maxsize=1)
def _loads(robot: Robot) -> Mapping[str, _Load]:
    """The loads of all links, each with the links that it carries, by name.

    One pass, because a robot may be a long chain. Links in loops of joints are left out.
    """
    poses = starting_poses(robot, commanded=False)
    children: dict[str, list[str]] = {}
    for child, holder in robot.inbound.items():
        children.setdefault(holder.parent, []).append(child)
    order = [name for name in robot.links if name not in robot.inbound]
    known = robot.links.keys() | robot.inbound.keys()
    order += [name for name in children if name not in known]  # such as the world
    for name in order:
        order += children.get(name, ())
    masses = dict.fromkeys(order, 0.0)
    moments = {name: np.zeros(3) for name in order}
    for name in reversed(order):
        link = robot.links.get(name)
        if link is not None and link.inertial is not None and link.gravity and name in poses:
            masses[name] += link.inertial.mass
            place = poses[name] @ link.inertial.pose
            moments[name] += link.inertial.mass * np.array(place.position)
        if name in robot.inbound:
            parent = robot.inbound[name].parent
            masses[parent] += masses[name]
            moments[parent] += moments[name]
    return {name: _Load(masses[name], moments[name]) for name in order}
