"""Whether a robot can stand: its centre of mass is above its support."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from cartwheel.checks.resting import center_of_mass, starting_poses
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.codes import robot as robot_codes
from cartwheel.description.solids import Floats
from cartwheel.errors import Diagnostic

_TOUCHES = 0.03
"""Maximum height of a supporting point above the lowest one, relative to the robot's size."""
_MARGIN = 0.01
"""Distance outside the support that is tolerated, relative to the robot's size."""
_DIRECTIONS = 64


@rule(robot_codes.UNBALANCED)
def balance(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        held = any(joint.parent == "world" for joint in robot.description.joints)
        if robot.description.static or held or not robot.is_placed or robot.incomplete:
            continue
        poses = starting_poses(robot)
        center = center_of_mass(robot, poses)
        clouds = [
            solid.placed(poses[link.name])
            for link in robot.description.links
            for solid in robot.collisions[link.name]
        ]
        if center is None or not clouds:
            continue
        points = np.concatenate(clouds)
        outside = _outside(points, center, robot.size)
        if outside > _MARGIN * robot.size:
            yield robot_codes.UNBALANCED.diagnostic(
                message=f"the centre of mass is {1000 * outside:.3g} mm outside the area between "
                "the points where the robot touches the ground, so it tips over",
                values={"outside": outside},
                origin=robot.description.origin,
                hint="Check whether all wheels and casters have a <collision> at the same height.",
            )


def _outside(points: Floats, center: Floats, size: float) -> float:
    """Distance of a point outside the convex hull of the lowest points, from above, m."""
    lowest = points[points[:, 2] <= points[:, 2].min() + _TOUCHES * size]
    angles = np.linspace(0.0, 2 * np.pi, _DIRECTIONS, endpoint=False)
    directions = np.stack([np.cos(angles), np.sin(angles)])
    reach = (lowest[:, :2] @ directions).max(axis=0)
    return float((center[:2] @ directions - reach).max())
