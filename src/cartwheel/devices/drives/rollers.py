"""Detects the rollers, friction and direction of omnidirectional wheels in a description."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np

from cartwheel.description.kinematics import link_poses
from cartwheel.description.model import RobotDescription
from cartwheel.geometry import rotate

_AGREE = 0.9
"""Minimum length of the mean of the wheels' axes, which are unit vectors."""
_SLIPPERY = 0.01
"""Friction coefficient below which a wheel does not move a robot."""
_NOISE = 1e-3
"""Smaller angles are rounding errors of the description, rad."""


def has_rollers(description: RobotDescription) -> bool:
    """Whether a collision has anisotropic friction that is fixed in the frame of a different link.

    This is a model of mecanum wheels, whose friction moves the robot. Other wheels only roll
    forward, so the robot needs a drive that pushes it.
    """
    surfaces = [c.surface for link in description.links for c in link.collisions]
    return any(each.fdir1_frame is not None and each.mu1 != each.mu2 for each in surfaces)


def has_roller_links(description: RobotDescription, joints: Collection[str]) -> bool:
    """Whether a link turns freely on each of these wheels: the rollers are links of their own.

    Args:
        description: The robot.
        joints: Joints of the wheels.
    """
    wheels = {each.child for each in description.joints if each.name in joints}
    turned = {each.parent for each in description.joints if each.type == "continuous"}
    return bool(wheels) and wheels <= turned


def has_grip(description: RobotDescription, joints: Collection[str]) -> bool:
    """Whether a wheel has friction. Robots that another drive pushes often have wheels without.

    Args:
        description: The robot.
        joints: Joints of the wheels.
    """
    wheels = {each.child for each in description.joints if each.name in joints}
    coefficients = [
        (collision.surface.mu1, collision.surface.mu2)
        for link in description.links
        if link.name in wheels
        for collision in link.collisions
    ]
    return not coefficients or any(
        mu is None or mu >= _SLIPPERY for pair in coefficients for mu in pair
    )


@dataclass(frozen=True, kw_only=True, slots=True)
class Rolling:
    """How wheels with positive speeds roll."""

    heading: float = 0.0
    """Direction of the robot's front, relative to the x axis of the base, rad."""
    backward: bool = False
    """Whether all wheels roll backward, because their axes point to the right."""


BACKWARD = (
    "the axes of the mecanum wheels point to the right of the robot, so it moves and turns in the "
    "opposite direction, as in Gazebo"
)
"""Describes wheels that roll backward."""
FORWARD = Rolling()
"""Wheels of a robot that faces along x."""


def rolling(description: RobotDescription, left: Sequence[str], right: Sequence[str]) -> Rolling:
    """Returns how wheels with positive speeds roll.

    It is the default for a robot that faces along x, and if the wheels' axes differ from each
    other or from the direction of the axles.

    Args:
        description: The robot.
        left: Joints of the left wheels.
        right: Joints of the right wheels.
    """
    poses = link_poses(description, {})
    front = poses[description.canonical_link].inverse()
    axes, sides = [], []
    for names in (left, right):
        joints = [each for each in description.joints if each.name in names]
        places = [front @ poses[each.child] @ each.pose for each in joints]
        if not places:
            return FORWARD
        axes += [
            rotate(place.orientation, each.axis.xyz)
            for place, each in zip(places, joints, strict=True)
        ]
        sides.append(np.mean([place.position for place in places], axis=0))
    mean, gap = np.mean(axes, axis=0), sides[0] - sides[1]
    wide = float(np.linalg.norm(gap))
    along = float(mean @ gap)
    if math.hypot(mean[0], mean[1]) < _AGREE or abs(along) < _AGREE * wide:
        return FORWARD
    toward_left = math.copysign(1.0, along) * mean
    angle = math.atan2(-toward_left[0], toward_left[1])
    return Rolling(heading=angle if abs(angle) > _NOISE else 0.0, backward=along < 0)
