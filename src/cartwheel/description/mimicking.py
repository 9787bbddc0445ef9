"""The positions to which leaders move the joints that mimic them."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

from cartwheel.description.model import Joint, Mimic

Range = tuple[float, float]
"""Lowest and highest position, rad or m; infinite without a limit."""
_LONGEST = 100
"""Number of leaders of leaders that are considered."""


def targets(
    mimic: Mimic, joints: Mapping[str, Joint], mimic_of: Callable[[Joint], Mimic | None]
) -> Range:
    """The positions to which a leader can move a follower.

    A leader without limits that follows another joint is as limited as that joint makes it.

    Args:
        mimic: What the follower follows.
        joints: The joints of the robot by name.
        mimic_of: Returns what a joint follows.
    """
    ratio, offset, leader = mimic.multiplier, mimic.offset, joints.get(mimic.joint)
    for _ in range(_LONGEST):
        if leader is None or not ratio:
            break
        above = mimic_of(leader)
        reach = stated_limits(leader, follows=above is not None)
        if reach is not None:
            ends = ratio * reach[0] + offset, ratio * reach[1] + offset
            return min(ends), max(ends)
        if above is None:
            break
        ratio, offset = ratio * above.multiplier, ratio * above.offset + offset
        leader = joints.get(above.joint)
    return (-math.inf, math.inf) if ratio else (offset, offset)


def stated_limits(joint: Joint, *, follows: bool) -> Range | None:
    """The limits of a joint with one degree of freedom; None without any.

    Equal limits of a follower do not count: they are placeholders.
    """
    axis = joint.axis
    if joint.type not in ("revolute", "prismatic") or (axis.locks and follows):
        return None
    if axis.lower is None and axis.upper is None:
        return None
    lower = -math.inf if axis.lower is None else axis.lower
    upper = math.inf if axis.upper is None else axis.upper
    return lower, upper
