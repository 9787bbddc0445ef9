"""Detects the rollers, friction and direction of omnidirectional wheels in a description."""

from __future__ import annotations

from collections.abc import Collection

from cartwheel.description.model import RobotDescription

BACKWARD = (
    "the axes of the mecanum wheels point to the right of the robot, so it moves and turns in the "
    "opposite direction, as in Gazebo"
)
"""Describes wheels that roll backward."""
_SLIPPERY = 0.01
"""Friction coefficient below which a wheel does not move a robot."""


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
