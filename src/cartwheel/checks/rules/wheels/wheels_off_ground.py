"""Whether the driven wheels touch the ground."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from cartwheel.checks import plugin_tags
from cartwheel.checks.resting import Rest, Surfaces, rest_of, starting_poses
from cartwheel.checks.robot import Robot
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.checks.wheels import (
    CAMBER,
    ROUND,
    gz_wheels,
    lowest,
    wheel_axis,
    wheel_joints,
    wheel_links,
    wheel_place,
    wheel_radius,
    wheel_widths,
)
from cartwheel.codes import robot as robot_codes
from cartwheel.description.kinematics import carried
from cartwheel.description.model import Joint, Link
from cartwheel.description.solids import bounds
from cartwheel.errors import Diagnostic, enumerated
from cartwheel.geometry import rotate

_SINKS = 3e-4
"""Height, m, from which a wheel does not drive, measured with carts of 1 to 100 kg."""
_STIFF = 1e6
"""Stiffness, N/m, of contacts into which no robot sinks noticeably."""
_GRAVITY = 9.81
_EXACT = 1e-5
"""m."""
_TOUCHING, _DEEP = 1e-4, 5e-4
"""m; a body that extends further below the wheels raises them from the ground."""
_WIDE = 0.2
"""Minimum width of a flat contact, relative to the robot's size."""
_GLIDES = 0.3
"""Maximum friction coefficient of parts that are meant to slide."""
_UP = np.array([0.0, 0.0, 1.0])
_VERTICAL = 0.99
"""Minimum vertical component of a steering axis."""


@rule(robot_codes.WHEELS_OFF_GROUND)
def wheels_off_ground(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        if robot.description.static or not robot.is_placed:
            continue
        yield from list(_lifting_links(robot)) or _raised_sides(robot)


def _are_raised(robot: Robot) -> bool:
    """Whether something holds driven wheels above the ground."""
    return any(True for _ in (*_lifting_links(robot), *_raised_sides(robot)))


@rule(robot_codes.BODY_ON_GROUND)
def body_on_ground(subject: Subject) -> Iterator[Diagnostic]:
    """Flat bodies at the height of the driven wheels, which carry a part of the weight."""
    for robot in subject.robots:
        if robot.description.static or not robot.is_placed:
            continue
        joints = wheel_joints(robot) or list(_commanded_wheels(robot))
        wheels = {name for joint in joints for name in wheel_links(robot, joint)}
        bases = {robot.rigid_root(joint.parent) for joint in joints}
        bottom = Surfaces(robot, wheels).lowest(_UP)
        if bottom is None or len(bases) != 1 or _are_raised(robot):
            continue
        for name in robot.rigid_groups.get(bases.pop(), []):
            if (
                name in wheels
                or not robot.whole(name, looks=False)
                or _rolls(robot, robot.links[name])
            ):
                continue
            for solid in robot.collisions[name]:
                points = solid.placed(robot.links[name].pose)
                low = points[points[:, 2] < bottom[2] + _TOUCHING]
                flat = len(low) > 0 and float(np.ptp(low[:, :2], axis=0).max())
                deep = float(bottom[2] - points[:, 2].min())
                mu = robot.links[name].collisions[0].surface.mu1
                if flat < _WIDE * robot.size or deep > _DEEP or (mu is not None and mu <= _GLIDES):
                    continue
                yield robot_codes.BODY_ON_GROUND.diagnostic(
                    message=f'the flat underside of link "{name}" is at the height of the lowest '
                    "points of the driven wheels, so it slides on the ground and brakes the robot",
                    values={"link": name, "depth": deep, "friction": mu},
                    origin=robot.links[name].collisions[0].origin,
                    hint="Raise the collision above the ground, or lower the wheels.",
                )
                break


def _commanded_wheels(robot: Robot) -> Iterator[Joint]:
    """The driven wheels of a robot whose drive states no sides, such as one with mecanum wheels."""
    ground = lowest(robot, *robot.links)
    for name in sorted(robot.driven | set(gz_wheels(robot))):
        joint = robot.joints.get(name)
        if joint is None or not joint.turns or joint.child not in robot.placed:
            continue
        widths = wheel_widths(robot, joint, robot.collisions)
        bottom = lowest(robot, *wheel_links(robot, joint))
        if widths is None or bottom is None or ground is None:
            continue
        level = abs(float(wheel_axis(robot, joint)[2])) < CAMBER
        if level and widths.min() >= ROUND * widths.max() and bottom - ground <= _DEEP:
            yield joint


def _low_links(robot: Robot) -> Iterator[Diagnostic]:
    """Links far below the driven wheels that are not meant to touch the ground."""
    joints = wheel_joints(robot)
    parts = {name for joint in joints for name in wheel_links(robot, joint)}
    heights = [
        lowest(robot, *wheel_links(robot, joint))
        for joint in joints
        if robot.whole(joint.child, looks=False)
    ]
    wheels = [height for height in heights if height is not None]
    if not wheels:
        return
    bottom = min(wheels)
    radius = wheel_radius(robot, joints[0]) or 0.1
    poses, limp = starting_poses(robot), _limp(robot)
    for link in robot.description.links:
        if link.name in parts or link.name in robot.cut or _rolls(robot, link):
            continue
        box = bounds([solid.placed(poses[link.name]) for solid in robot.collisions[link.name]])
        height = None if box is None else float(box[0][2])
        if height is None or bottom - height <= max(0.1 * radius, 0.005) or link.name in limp:
            continue
        yield robot_codes.WHEELS_OFF_GROUND.diagnostic(
            message=f'the collision of link "{link.name}" extends '
            f"{1000 * (bottom - height):.3g} mm below the driven wheels, so they do "
            "not touch the ground",
            values={"link": link.name, "depth": bottom - height},
            origin=link.collisions[0].origin,
            hint=f'Raise the collision, or lower the joint of "{joints[0].child}".',
        )


def _rolls(robot: Robot, link: Link) -> bool:
    """Whether the link is an undriven wheel or a caster, which is meant to touch the ground."""
    holder = robot.inbound.get(link.name)
    moves = holder is not None and holder.type in ("continuous", "ball", "revolute", "prismatic")
    name = link.name.lower()
    return moves or any(word in name for word in ("caster", "castor", "wheel", "roller", "ball"))


def _limp(robot: Robot) -> set[str]:
    """The links that yield, because nothing holds one of the joints between them and the root."""
    moved = robot.driven | {
        name
        for tag in robot.description.plugins
        for role in plugin_tags.roles_with(tag.filename, "joint", "other_joint")
        for name in role.joints(tag.element)
    }
    joints = list(itertools.chain(*_below(robot).values()))
    loose = (
        joint.child
        for joint in joints
        if joint.type != "fixed" and joint.name not in moved and joint.mimic is None
        if not (joint.axis.locks or joint.axis.friction or joint.axis.spring_stiffness)
    )
    return carried(joints, loose)


def _below(robot: Robot) -> dict[str, list[Joint]]:
    """The joints that each link holds."""
    below: dict[str, list[Joint]] = {name: [] for name in robot.links}
    for joint in robot.inbound.values():
        if joint.child in below and joint.parent in below:
            below[joint.parent].append(joint)
    return below


@dataclass(frozen=True, kw_only=True, slots=True)
class _Standing:
    """How the wheels of a drive stand on the plane on which the robot rests."""

    rigid: list[str]
    """The links that rest on it."""
    bearing: list[str]
    """Those that touch it."""
    wheels: set[str]
    """The links of all wheels."""
    raised: list[str]
    """The wheels of a side of which none touches it."""


def _raised_sides(robot: Robot) -> Iterator[Diagnostic]:
    """Drives whose left or right wheels are all above the plane on which the robot stands."""
    for each in _standing(robot):
        if each.raised:
            others = [name for name in each.rigid if name not in each.wheels]
            yield from _report(robot, others, each.bearing, each.raised, each.wheels)


def _lifting_links(robot: Robot) -> Iterator[Diagnostic]:
    """Low links, but none with which the robot also stands on its wheels, because it tilts."""
    found = list(_low_links(robot))
    standing = _standing(robot) if found else []
    if not standing or any(each.raised for each in standing):
        yield from found
        return
    yield from (each for each in found if each.values["link"] not in standing[0].rigid)


def _standing(robot: Robot) -> list[_Standing]:
    """How the wheels of each drive stand; none if it is unknown."""
    return robot.once("standing", (), lambda: list(_found_standing(robot)))


def _found_standing(robot: Robot) -> Iterator[_Standing]:
    held = any(joint.parent == "world" for joint in robot.description.joints)
    joints = wheel_joints(robot)
    names = {joint.name for joint in joints}
    if held or not joints or not all(robot.whole(joint.child, looks=False) for joint in joints):
        return
    below = _below(robot)
    rigid = _rigid(robot, below)
    rest = rest_of(robot, rigid)
    if rest is None:
        return
    bearing = [name for name in rigid if (rest.height(robot, [name]) or 0.0) < _SINKS]
    limit = _SINKS + _softness(robot, bearing)
    for pair in robot.sides:
        sides = [
            [
                (joint, _wheel(joint, below))
                for joint in (robot.joints[name] for name in side if name in names)
            ]
            for side in pair
        ]
        wheels = {name for side in sides for _, wheel in side for name in wheel}
        if not wheels <= set(rigid):
            continue
        heights = [
            min((_gap(robot, rest, names, joint) for joint, names in side), default=0.0)
            for side in sides
        ]
        raised = [
            names[0]
            for side, height in zip(sides, heights, strict=True)
            if height > limit
            for _, names in side
        ]
        yield _Standing(rigid=rigid, bearing=bearing, wheels=wheels, raised=raised)


def _gap(robot: Robot, rest: Rest, links: list[str], joint: Joint) -> float:
    """Height of a wheel above the plane where its radius is largest, m.

    The wheel of a mesh has corners, and may start with the middle of an edge down.
    """
    height = rest.height(robot, links) or 0.0
    radius = wheel_radius(robot, joint)
    if radius is None:
        return height
    center = wheel_place(robot, joint).position
    return min(height, float(rest.normal @ np.array(center)) - rest.offset - radius)


def _report(
    robot: Robot, others: list[str], bearing: list[str], raised: list[str], wheels: set[str]
) -> Iterator[Diagnostic]:
    """A finding, unless no other part is lower than the wheels while the robot is level."""
    bottom = Surfaces(robot, wheels).lowest(_UP)
    points = {name: Surfaces(robot, [name]).lowest(_UP) for name in others}
    low = {
        name: float(bottom[2] - point[2])
        for name, point in points.items()
        if bottom is not None and point is not None and bottom[2] - point[2] > _EXACT
    }
    feet = [name for name in low if name in bearing]
    if not feet:
        return
    amounts = {name: f"{1000 * depth:.2g} mm" for name, depth in low.items()}
    yield robot_codes.WHEELS_OFF_GROUND.diagnostic(
        message=f"the robot stands on {_quoted(feet)}, "
        f"{enumerated([amounts[name] for name in feet])} below the driven wheels, so "
        f"{_quoted(raised)} {'does' if len(raised) == 1 else 'do'} not touch the ground",
        values={"links": tuple(feet), "depth": max(low[name] for name in feet)},
        origin=robot.links[feet[0]].collisions[0].origin,
        hint="Raise "
        + enumerated([f'"{name}" by {amount}' for name, amount in amounts.items()])
        + ", or lower the wheels.",
    )


def _quoted(names: Iterable[str]) -> str:
    return enumerated(f'"{name}"' for name in names)


def _wheel(joint: Joint, below: Mapping[str, list[Joint]]) -> list[str]:
    """The links that a wheel's joint holds, including the rollers of a mecanum wheel."""
    found = {joint.child: None}
    waiting = [joint.child]
    while waiting:
        children = [each.child for each in below[waiting.pop()] if each.child not in found]
        found.update(dict.fromkeys(children))
        waiting += children
    return list(found)


def _rigid(robot: Robot, below: Mapping[str, list[Joint]]) -> list[str]:
    """The links that the robot's weight does not move up or down.

    Joints that steer or roll do not let it; springs, rockers and arms do.
    """
    # Whether an undriven joint above the link rolls: a further one would make it a rocker.
    rolled = dict.fromkeys((name for name in robot.links if name not in robot.inbound), False)
    waiting = list(rolled)
    while waiting:
        parent = waiting.pop()
        for joint in below[parent]:
            axis = rotate(robot.links[joint.child].pose.orientation, joint.axis.xyz)
            turns = joint.type in ("continuous", "revolute") and abs(axis[2]) > _VERTICAL
            rolls = (joint.turns or joint.type == "ball") and not turns
            if joint.type != "fixed" and not turns and (not rolls or rolled[parent]):
                continue
            rolled[joint.child] = rolled[parent] or (rolls and joint.name not in robot.driven)
            waiting.append(joint.child)
    return [name for name in robot.links if name in rolled and name not in robot.cut]


def _softness(robot: Robot, bearing: Iterable[str]) -> float:
    """How far the robot sinks at most into contacts that are stated to be soft, m."""
    stated = [c.surface.kp for name in bearing for c in robot.links[name].collisions]
    softest = min((kp for kp in stated if kp is not None and kp > 0), default=_STIFF)
    return robot.description.mass * _GRAVITY / softest if softest < _STIFF else 0.0
