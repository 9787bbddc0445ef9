"""Whether the rollers of mecanum wheels are in a robot's description."""

from __future__ import annotations

from cartwheel.description.model import RobotDescription


def has_rollers(description: RobotDescription) -> bool:
    """Whether surfaces of it glide one way and grip the other, as seen from another link.

    That is how new Gazebo's mecanum wheels are written, ``fdir1`` with ``gz:expressed_in``: what
    they touch takes the robot along. Others roll like any wheel, and something has to push it.
    """
    surfaces = [c.surface for link in description.links for c in link.collisions]
    return any(each.fdir1_frame is not None and each.mu1 != each.mu2 for each in surfaces)
