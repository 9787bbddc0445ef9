"""Whether a robot can stand: its centre of mass is above its support."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from cartwheel.checks.resting import Rest, rest_of, starting_poses
from cartwheel.checks.robot import Robot
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.checks.wheels import (
    CAMBER,
    ROUND,
    lowest,
    passive_axle,
    wheel_axis,
    wheel_joints,
    wheel_links,
    wheel_middle,
    wheel_radius,
    wheel_widths,
)
from cartwheel.codes import robot as robot_codes
from cartwheel.description.kinematics import center_of_mass
from cartwheel.description.model import Joint, Link, Sphere
from cartwheel.description.solids import Floats
from cartwheel.errors import Diagnostic, Value, enumerated

_TOUCHES = 0.03
"""Maximum height of a supporting point above the lowest one, relative to the robot's size."""
_MARGIN = 0.01
"""Distance outside the support that is tolerated, relative to the robot's size."""
_DIRECTIONS = 64
_HIGH = 0.75
"""Height of links that do not touch the ground, relative to that of the robot."""
_TILTED = 0.1
"""Smallest angle of a robot that is reported to be tilted, rad."""
_FLAT = 0.005
"""Largest height of a point on which the robot rests, relative to its size."""
_KEPT = 0.5
"""Part of the energy of the fall that remains when a part touches the ground."""
_FALLEN = math.radians(30.0)
"""Smallest angle at which a robot is said to have fallen over."""
_CASTER = re.compile(r"cast[eo]r|ball", re.IGNORECASE)
_SLIPPERY = 0.1
"""Largest friction coefficient of a part that is meant to slide."""
_SHOWN = 3
"""Number of links that a message names."""
_LEGS = 3
"""Links that a robot needs to stand."""
_EVEN = 0.001
"""Difference of heights that does not matter, relative to the robot's size."""
_LATER = 1.5
"""Largest ratio of the angle at which a caster touches the ground to that of the first link: the
body may touch the ground before casters that are too high."""


@rule(robot_codes.UNBALANCED)
def balance(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        held = any(joint.parent == "world" for joint in robot.description.joints)
        if robot.description.static or held or not robot.is_placed or _lacks_support(robot):
            continue
        poses = starting_poses(robot)
        center = center_of_mass(robot.description, poses)
        clouds = [
            solid.placed(poses[link.name])
            for link in robot.description.links
            for solid in robot.collisions[link.name]
        ]
        if center is None or not clouds:
            continue
        points = np.concatenate(clouds)
        rest = rest_of(robot, [link.name for link in robot.description.links])
        outside = _outside(points, center, robot.size)
        if rest is not None:
            # On wheels alone, this is where the robot would balance, not where it comes to rest.
            yield from (
                _on_one_wheel(robot, rest)
                or _on_an_axle(robot, center, rest)
                or _tilted(robot, center, points, rest)
            )
        elif outside > _MARGIN * robot.size:
            yield robot_codes.UNBALANCED.diagnostic(
                message=f"the centre of mass is {1000 * outside:.3g} mm outside the area between "
                "the points where the robot touches the ground, so it tips over",
                values={"outside": outside},
                origin=robot.description.origin,
                hint="Check whether all wheels and casters have a <collision> at the same height.",
            )
        else:
            yield from _on_an_axle(robot, center, None)


def _lacks_support(robot: Robot) -> bool:
    """Whether a missing collision may be one that carries the robot: none near its top is."""
    if not robot.uncovered:
        return False
    clouds = [
        solid.placed(link.pose)[:, 2]
        for link in robot.description.links
        for solid in robot.collisions[link.name]
    ]
    if robot.cut or not clouds:
        return True
    heights = np.concatenate(clouds)
    high = heights.min() + _HIGH * np.ptp(heights)
    return any(robot.links[name].pose.position[2] < high for name in robot.uncovered)


def _tilted(robot: Robot, center: Floats, points: Floats, rest: Rest) -> Iterator[Diagnostic]:
    """A robot that rests far from level, or falls over before.

    Args:
        robot: The robot.
        center: Its centre of mass in the model frame, m, shape (3,).
        points: The corners of its collisions, m, shape (n, 3).
        rest: Where it rests.
    """
    tilt = math.acos(min(1.0, float(rest.normal[2])))
    if tilt <= _TILTED:
        return
    if _topples(center, points, rest, robot.size):
        yield robot_codes.UNBALANCED.diagnostic(
            message="the area on which the robot stands is so small that it falls over, unless a "
            "program balances it",
            values={"outside": 0.0, "falls": True},
            origin=robot.description.origin,
            hint="Start the program that balances the robot.",
        )
        return
    on = [
        name
        for name in robot.links
        if (height := rest.height(robot, [name])) is not None and height < _FLAT * robot.size
    ]
    tilts = f"so it tilts by {math.degrees(tilt):.2g}°"
    message = f"the points on which the robot rests have different heights, {tilts}"
    hint = "Check whether all wheels and casters touch the ground at the same height."
    lows = {name: low for name in robot.links if (low := lowest(robot, name)) is not None}
    level = [name for name in lows if lows[name] <= min(lows.values()) + _FLAT * robot.size]
    extra = [name for name in on if name not in level]
    outside = _outside(points, center, robot.size, touching=_EVEN)
    if len(level) >= _LEGS and extra and outside > 0.0:
        message = (
            f"the centre of mass is {1000 * outside:.3g} mm outside the area between "
            f"{_listed(level)}, which have the same height, {tilts} onto {_listed(extra)}"
        )
        hint = "Check whether a wheel or caster is missing, or is at the wrong place."
    elif on:
        message += f" on {_listed(on)}"
    yield robot_codes.UNBALANCED.diagnostic(
        message=message,
        values={"tilt": tilt, "links": tuple(on)},
        origin=robot.description.origin,
        hint=hint,
    )


def _listed(names: Sequence[str]) -> str:
    """Names in quotation marks, the first of many."""
    shown = [f'"{name}"' for name in names]
    if len(shown) > _SHOWN:
        shown = [*shown[:_SHOWN], f"{len(shown) - _SHOWN} more"]
    return enumerated(shown)


def _topples(center: Floats, points: Floats, rest: Rest, size: float) -> bool:
    """Whether a robot that tilts until it rests has enough energy to tip over the edge there."""
    first = np.cross(rest.normal, (1.0, 0.0, 0.0) if abs(rest.normal[0]) < 0.5 else (0.0, 1.0, 0.0))
    first /= np.linalg.norm(first)
    angles = np.linspace(0.0, 2 * np.pi, _DIRECTIONS, endpoint=False)
    directions = np.outer(first, np.cos(angles)) + np.outer(
        np.cross(rest.normal, first), np.sin(angles)
    )
    near = points[points @ rest.normal - rest.offset < _FLAT * size]
    if not len(near):
        return False
    margin = max(0.0, float(((near - center) @ directions).max(axis=0).min()))
    height = float(rest.normal @ center - rest.offset)
    released = float(center[2] - points[:, 2].min()) - height
    return math.hypot(height, margin) - height < _KEPT * released


def _on_one_wheel(robot: Robot, rest: Rest) -> list[Diagnostic]:
    """A robot that stands only on one wheel, about whose axle it turns; empty for another one."""
    margin = _MARGIN * robot.size
    groups = {
        robot.rigid_root(name)
        for name in robot.links
        if (height := rest.height(robot, [name])) is not None and height < margin
    }
    joint = robot.inbound.get(next(iter(groups), ""))
    if len(groups) > 1 or joint is None or not joint.turns:
        return []
    if np.linalg.norm(np.cross(wheel_axis(robot, joint), rest.normal)) < CAMBER:
        # It stands on a turntable.
        return []
    return [
        robot_codes.UNBALANCED.diagnostic(
            message=f'the robot stands only on the wheel "{joint.child}", so it falls over, unless '
            "a program balances it",
            values={"outside": 0.0, "falls": True, "wheel": joint.child},
            origin=joint.origin,
            hint="Check the places of the wheels, or start the program that balances the robot.",
        )
    ]


def _on_an_axle(robot: Robot, center: Floats, rest: Rest | None) -> list[Diagnostic]:
    """A robot that stands only on wheels with a common axle; empty for another one.

    Args:
        robot: The robot.
        center: Its centre of mass in the model frame, m, shape (3,).
        rest: Where it balances or stands; None if no such place was found.
    """
    joints = wheel_joints(robot)
    if not joints and rest is not None:
        # A program may balance the robot by efforts on single joints.
        joints = [robot.joints[name] for name in passive_axle(robot, ())]
    wheels = {name for joint in joints for name in wheel_links(robot, joint)}
    others = [name for name in robot.links if name not in wheels]
    height = rest.height(robot, others) if rest is not None else None
    if height is not None and height < _MARGIN * robot.size:
        return []
    if len(joints) < 2 or not all(joint.child in robot.placed for joint in joints):
        return []
    axis = wheel_axis(robot, joints[0])
    places = np.array([wheel_middle(robot, joint) for joint in joints])
    gaps = places - places[0]
    off = np.linalg.norm(gaps - np.outer(gaps @ axis, axis), axis=1)
    if off.max() >= _MARGIN * robot.size:
        return []
    casters = _raised_casters(robot, others, joints[0])
    normal = rest.normal if rest is not None else np.array([0.0, 0.0, 1.0])
    falls = bool((center - places[0]) @ normal > 0.0)
    values: dict[str, Value] = {}
    if casters:
        how = "tips onto a caster"
    elif falls:
        how, values = _fall(robot, others, joints[0], center)
    else:
        how = "pitches while it drives, unless a program balances it"
    message = f"the robot stands only on wheels with a common axle, so it {how}"
    hint = "Add a caster, or start the program that balances the robot."
    values |= {"outside": 0.0, "falls": falls}
    if casters:
        nearest = min(casters.values())
        far = f"{1000 * nearest:.3g} mm"
        even = max(casters.values()) <= nearest + _EVEN * robot.size
        message += f": {_named(casters)} {far if even else f'at least {far}'} above the ground"
        hint = f"Lower the casters by {far}, or raise the wheels."
        values |= {"casters": tuple(sorted(casters)), "height": nearest}
    return [
        robot_codes.UNBALANCED.diagnostic(
            message=message, values=values, origin=robot.description.origin, hint=hint
        )
    ]


def _fall(
    robot: Robot, links: Sequence[str], wheel: Joint, center: Floats
) -> tuple[str, dict[str, Value]]:
    """What a robot does whose centre of mass is above the axle of its wheels.

    Args:
        robot: The robot.
        links: Its links apart from the wheels.
        wheel: The joint of a wheel on the axle.
        center: Its centre of mass in the model frame, m, shape (3,).

    Returns:
        The end of a sentence, and the angle in rad and the link that touches the ground then.
    """
    tilts = _angles(robot, links, wheel)
    ahead = float((center - np.array(wheel_middle(robot, wheel))) @ _ahead(robot, wheel))
    level = abs(ahead) < _MARGIN * robot.size
    sides = (0, 1) if level else (0,) if ahead > 0 else (1,)
    angle, link = min(
        ((each[side], name) for name, each in tilts.items() for side in sides),
        default=(np.inf, ""),
    )
    if not np.isfinite(angle):
        return "falls over, unless a program balances it", {}
    degrees = f"{math.degrees(angle):.3g}°"
    how = f'tips by {degrees} until "{link}" touches the ground'
    if angle > _FALLEN:
        how = f'falls over by {degrees} until "{link}" touches the ground'
    return f"{how}, unless a program balances it", {"angle": angle, "touches": link}


def _ahead(robot: Robot, wheel: Joint) -> Floats:
    """The horizontal direction across an axle, shape (3,), or a shorter vector if it is upright."""
    ahead = np.cross(wheel_axis(robot, wheel), (0.0, 0.0, 1.0))
    length = float(np.linalg.norm(ahead))
    return ahead if length < CAMBER else ahead / length


def _height(robot: Robot, wheel: Joint) -> float | None:
    """Height of an axle above the ground on which its wheel stands, m, which may lie flat."""
    widths = wheel_widths(robot, wheel, robot.collisions)
    lows = [low for name in wheel_links(robot, wheel) if (low := lowest(robot, name)) is not None]
    if widths is None or not lows or widths.min() >= ROUND * widths.max():
        return wheel_radius(robot, wheel)
    return float(wheel_middle(robot, wheel)[2]) - min(lows)


def _angles(robot: Robot, links: Sequence[str], wheel: Joint) -> dict[str, tuple[float, float]]:
    """The angles by which links turn about an axle until they touch the ground; see `_tilts`."""
    radius, ahead = _height(robot, wheel), _ahead(robot, wheel)
    axle = np.array(wheel_middle(robot, wheel))
    if radius is None or np.linalg.norm(ahead) < CAMBER:
        return {}
    tilts: dict[str, tuple[float, float]] = {}
    for name in links:
        clouds = [solid.placed(robot.links[name].pose) for solid in robot.collisions[name]]
        if clouds:
            points = np.concatenate(clouds) - axle
            tilts[name] = _tilts(points @ ahead, -points[:, 2], radius)
    return tilts


def _named(casters: Mapping[str, float]) -> str:
    """The lowest casters as the subject of a sentence, with a verb."""
    names = sorted(casters, key=lambda name: (casters[name], name))
    if len(names) == 1:
        return f"its caster {_listed(names)} is"
    return f"its casters {_listed(names)} are"


def _raised_casters(robot: Robot, links: Sequence[str], wheel: Joint) -> dict[str, float]:
    """Heights above level ground, m, of the casters on which a robot tips that turns on its axle.

    Args:
        robot: The robot.
        links: Its links apart from the wheels.
        wheel: The joint of a wheel on the axle.
    """
    radius, axle = _height(robot, wheel), np.array(wheel_middle(robot, wheel))
    tilts = _angles(robot, links, wheel)
    if radius is None:
        return {}
    found = {}
    for side in range(2):
        least = min((each[side] for each in tilts.values()), default=np.inf)
        for name, each in tilts.items():
            low = lowest(robot, name)
            if each[side] <= _LATER * least < np.inf and low is not None:
                found[name] = low - float(axle[2]) + radius
    return {name: height for name, height in found.items() if _is_caster(robot.links[name])}


def _tilts(ahead: Floats, below: Floats, radius: float) -> tuple[float, float]:
    """Angles by which a link turns about an axle until a point touches the ground, rad.

    Args:
        ahead: Distances of its points ahead of the axle, m, shape (n,).
        below: Distances of its points below the axle, m, shape (n,).
        radius: Height of the axle above the ground, m.

    Returns:
        The angles to the front and to the back; infinite if nothing ever touches the ground there.
    """
    away = np.hypot(ahead, below)
    reach = np.arccos(radius / np.maximum(away, radius))
    angle = np.arctan2(ahead, below)
    front, back = (
        np.where((side * angle > 0) & (away > radius), side * angle - reach, np.inf).min()
        for side in (1.0, -1.0)
    )
    return float(front), float(back)


def _is_caster(link: Link) -> bool:
    """Whether a link is named like a caster, or is a ball or slides without much friction."""
    if _CASTER.search(link.name):
        return True
    slides = [
        isinstance(each.shape, Sphere)
        or (each.surface.mu1 is not None and each.surface.mu1 <= _SLIPPERY)
        for each in link.collisions
    ]
    return bool(slides) and all(slides)


def _outside(points: Floats, center: Floats, size: float, touching: float = _TOUCHES) -> float:
    """Distance of a point outside the convex hull of the lowest points, from above, m.

    `touching` is the height up to which points count, relative to the robot's size.
    """
    lowest = points[points[:, 2] <= points[:, 2].min() + touching * size]
    angles = np.linspace(0.0, 2 * np.pi, _DIRECTIONS, endpoint=False)
    directions = np.stack([np.cos(angles), np.sin(angles)])
    reach = (lowest[:, :2] @ directions).max(axis=0)
    return float((center[:2] @ directions - reach).max())
