"""Detects the rollers of mecanum wheels in a robot's description."""

from __future__ import annotations

from cartwheel.description.model import RobotDescription


def has_rollers(description: RobotDescription) -> bool:
    """Whether a collision has anisotropic friction that is fixed in the frame of a different link.

    This is a model of mecanum wheels, whose friction moves the robot. Other wheels only roll
    forward, so the robot needs a drive that pushes it.
    """
    surfaces = [c.surface for link in description.links for c in link.collisions]
    return any(each.fdir1_frame is not None and each.mu1 != each.mu2 for each in surfaces)
