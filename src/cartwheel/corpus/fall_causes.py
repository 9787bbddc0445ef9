"""Explains why a robot does not stand, by diagnostics."""

from __future__ import annotations

from collections.abc import Sequence

from cartwheel.codes import files, robot
from cartwheel.corpus.faults import coded, most_severe
from cartwheel.corpus.verdict import Stand
from cartwheel.description.model import Joint, RobotDescription
from cartwheel.errors import Diagnostic

_STANDING = frozenset(
    {
        files.FILE_MISSING,
        files.MESH_UNREADABLE,
        robot.BASE_WITHOUT_COLLISION,
        robot.WHEEL_WITHOUT_COLLISION,
        robot.WHEELS_OFF_GROUND,
        robot.INERTIA_MISSING,
        robot.JOINT_LINK_UNKNOWN,
        robot.UNBALANCED,
        robot.OVERLAPPING_COLLISIONS,
        robot.JOINTS_UNDRIVEN,
    }
)
_ABSENT = frozenset({files.FILE_MISSING, files.FILE_ON_NETWORK, files.MESH_UNREADABLE})
"""Reasons why a shape is missing."""
LEFT_OUT = frozenset({files.INCLUDE_ABSENT, files.MACRO_ABSENT})
"""Reasons why a part of the robot is missing."""
_FALLEN = 1.0
"""m, or robot sizes if it is longer than 1 m, by which only a robot sinks that falls through the
ground."""


def cause_of_fall(
    stand: Stand,
    description: RobotDescription,
    found: Sequence[Diagnostic],
    idle: Diagnostic | None,
) -> Diagnostic | None:
    """Why a robot does not stand.

    Args:
        stand: How it stood.
        description: The robot.
        found: Diagnostics of the run and of `cartwheel check`.
        idle: The reason why no controller holds the joints, apart from those that only publish;
            None if one does or none is needed.
    """
    lost = next((each for each in found if _is_body_lost(each, description)), None)
    if lost is not None:
        return lost
    reasons = [each for each in found if _explains_fall(each)]
    absent = coded(found, LEFT_OUT)
    if absent is not None and any(each.code is robot.BASE_WITHOUT_COLLISION for each in reasons):
        # The collisions may be in the part that was left out.
        bodies = [each for each in reasons if each.code is robot.BASE_WITHOUT_COLLISION]
        reasons = [absent, *(each for each in reasons if each not in bodies)]
    if falls_through(stand):
        bottomless = coded(reasons, frozenset({robot.BASE_WITHOUT_COLLISION}))
        if bottomless is not None:
            return bottomless
    if idle is not None:
        left_out = {robot.JOINTS_UNDRIVEN}
        if any(_bends(joint) for joint in description.joints):
            # Limbs that nothing holds give way; links without an inertia have a mass here.
            left_out.add(robot.INERTIA_MISSING)
        reasons = [each for each in reasons if each.code not in left_out]
    if any(each.code is robot.UNBALANCED for each in reasons):
        # It is reported only if no missing collision can carry the robot, and is computed with the
        # masses of all links.
        reasons = [each for each in reasons if each.code not in _ABSENT | {robot.INERTIA_MISSING}]
    return most_severe(reasons) or idle


def falls_through(stand: Stand) -> bool:
    """Whether a robot sank so far that it fell through the ground."""
    return stand.sunk > _FALLEN * max(1.0, stand.size)


def _bends(joint: Joint) -> bool:
    """Whether it is the joint of a limb rather than of a wheel."""
    return joint.type in ("revolute", "prismatic") and joint.axis.lower is not None


def _explains_fall(each: Diagnostic) -> bool:
    if each.code in _ABSENT:
        return each.values.get("left_out") == "collision"
    return each.code in _STANDING


def _is_body_lost(each: Diagnostic, description: RobotDescription) -> bool:
    """Whether the root link is empty because the included file that defines it is absent."""
    held = {joint.child for joint in description.joints}
    return (
        each.code is files.LINK_RECONNECTED
        and not each.values.get("parent")
        and each.values.get("link") not in held
    )
