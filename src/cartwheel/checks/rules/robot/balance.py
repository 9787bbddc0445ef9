"""Whether a robot can stand: its centre of mass is above its support."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from cartwheel.checks.resting import Rest, rest_of, starting_poses
from cartwheel.checks.robot import Robot
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.checks.wheels import (
    passive_axle,
    wheel_axis,
    wheel_joints,
    wheel_links,
    wheel_middle,
)
from cartwheel.codes import robot as robot_codes
from cartwheel.description.kinematics import center_of_mass
from cartwheel.description.solids import Floats
from cartwheel.errors import Diagnostic

_TOUCHES = 0.03
"""Maximum height of a supporting point above the lowest one, relative to the robot's size."""
_MARGIN = 0.01
"""Distance outside the support that is tolerated, relative to the robot's size."""
_DIRECTIONS = 64
_HIGH = 0.75
"""Height of links that do not touch the ground, relative to that of the robot."""
_TILTED = 0.1
"""Smallest angle of a robot that is reported to be tilted, rad."""


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
            yield from _tilted(robot, rest)
            if outside <= _MARGIN * robot.size:
                yield from _on_an_axle(robot, rest)
        elif outside > _MARGIN * robot.size:
            yield robot_codes.UNBALANCED.diagnostic(
                message=f"the centre of mass is {1000 * outside:.3g} mm outside the area between "
                "the points where the robot touches the ground, so it tips over",
                values={"outside": outside},
                origin=robot.description.origin,
                hint="Check whether all wheels and casters have a <collision> at the same height.",
            )
        else:
            yield from _on_an_axle(robot, None)


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


def _tilted(robot: Robot, rest: Rest) -> Iterator[Diagnostic]:
    """A robot that rests far from level."""
    tilt = math.acos(min(1.0, float(rest.normal[2])))
    if tilt > _TILTED:
        yield robot_codes.UNBALANCED.diagnostic(
            message="the points on which the robot rests have different heights, so it tilts by "
            f"{math.degrees(tilt):.2g}°",
            values={"tilt": tilt},
            origin=robot.description.origin,
            hint="Check whether all wheels and casters touch the ground at the same height.",
        )


def _on_an_axle(robot: Robot, rest: Rest | None) -> Iterator[Diagnostic]:
    """A robot that stands only on wheels with a common axle."""
    joints = wheel_joints(robot)
    if not joints and rest is not None:
        # A program may balance the robot by efforts on single joints.
        joints = [robot.joints[name] for name in passive_axle(robot, ())]
    wheels = {name for joint in joints for name in wheel_links(robot, joint)}
    others = [name for name in robot.links if name not in wheels]
    height = rest.height(robot, others) if rest is not None else None
    if height is not None and height < _MARGIN * robot.size:
        return
    if len(joints) < 2 or not all(joint.child in robot.placed for joint in joints):
        return
    axis = wheel_axis(robot, joints[0])
    places = np.array([wheel_middle(robot, joint) for joint in joints])
    gaps = places - places[0]
    off = np.linalg.norm(gaps - np.outer(gaps @ axis, axis), axis=1)
    if off.max() < _MARGIN * robot.size:
        yield robot_codes.UNBALANCED.diagnostic(
            message="the robot stands only on wheels with a common axle, so it pitches while it "
            "drives, unless a program balances it",
            values={"outside": 0.0},
            origin=robot.description.origin,
            hint="Add a caster, or start the program that balances the robot.",
        )


def _outside(points: Floats, center: Floats, size: float) -> float:
    """Distance of a point outside the convex hull of the lowest points, from above, m."""
    lowest = points[points[:, 2] <= points[:, 2].min() + _TOUCHES * size]
    angles = np.linspace(0.0, 2 * np.pi, _DIRECTIONS, endpoint=False)
    directions = np.stack([np.cos(angles), np.sin(angles)])
    reach = (lowest[:, :2] @ directions).max(axis=0)
    return float((center[:2] @ directions - reach).max())
