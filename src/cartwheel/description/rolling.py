"""The direction in which the wheels of a base roll."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cartwheel.description.kinematics import link_poses
from cartwheel.description.model import RobotDescription
from cartwheel.geometry import rotate

_AGREE = 0.9
"""Minimum length of the mean of the wheels' axes, which are unit vectors."""
_NOISE = 1e-3
"""Smaller angles are rounding errors of the description, rad."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Rolling:
    """How wheels with positive speeds roll."""

    heading: float = 0.0
    """Direction of the robot's front, relative to the x axis of the base, rad."""
    backward: bool = False
    """Whether all wheels roll backward, because their axes point to the right."""


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
