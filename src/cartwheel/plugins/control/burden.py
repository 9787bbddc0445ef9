"""What the weight of a robot's parts asks of its joints."""

from __future__ import annotations

import math

from cartwheel.description.kinematics import link_poses
from cartwheel.description.model import RobotDescription

_GRAVITY = 9.8
"""m/s²."""


def burden(description: RobotDescription, name: str) -> float:
    """The most that gravity can ask of a joint, N m, or N of one that slides.

    Whatever pose the robot is in: all that the joint carries is held out straight.
    """
    joint = description.joint(name)
    assert joint is not None
    poses = link_poses(description, {})
    masses = {link.name: link.inertial for link in description.links}
    pivot = poses[joint.child] @ joint.pose
    waiting = [(joint.child, pivot.position, 0.0)]
    seen = {joint.child}
    mass = moment = 0.0
    while waiting:
        link, pivot_place, arm = waiting.pop()
        inertial = masses[link]
        if inertial is not None:
            centre = (poses[link] @ inertial.pose).position
            mass += inertial.mass
            moment += inertial.mass * (arm + math.dist(pivot_place, centre))
        for other in description.joints:
            if other.parent != link or other.child in seen:
                continue
            seen.add(other.child)
            if other.type == "fixed":
                waiting.append((other.child, pivot_place, arm))
            else:
                place = (poses[other.child] @ other.pose).position
                waiting.append((other.child, place, arm + math.dist(pivot_place, place)))
    return _GRAVITY * (mass if joint.type == "prismatic" else moment)
