"""Inertias that explain why a robot rocks, or hardly moves."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from cartwheel.codes import robot
from cartwheel.corpus.faults import most_severe
from cartwheel.description.model import RobotDescription
from cartwheel.errors import Diagnostic

_FLYWHEEL = 20.0
"""Ratio of a wheel's inertia to the largest that it can have, beyond which it may tip a robot."""
_SLUGGISH = 100.0
"""Ratio of a body's inertia to the largest that it can have, beyond which no usual motor or tyre
turns it."""


def flywheel(found: Iterable[Diagnostic], description: RobotDescription) -> Diagnostic | None:
    """A wheel of such an inertia that the reaction to its acceleration tips the robot."""
    # SDF's wheels have revolute joints without limits.
    wheels = {
        joint.child
        for joint in description.joints
        if joint.type == "continuous" or (joint.type == "revolute" and joint.axis.lower is None)
    }
    return most_severe(
        each for each in _too_large(found, _FLYWHEEL) if each.values.get("link") in wheels
    )


def sluggish(found: Iterable[Diagnostic], ratio: float) -> Diagnostic | None:
    """A body of such an inertia that it hardly turns, if a robot moves too slowly.

    Args:
        found: What is known about the robot.
        ratio: The velocity relative to the commanded one.
    """
    return most_severe(_too_large(found, _SLUGGISH)) if abs(ratio) < 1.0 else None


def _too_large(found: Iterable[Diagnostic], least: float) -> Iterator[Diagnostic]:
    """The findings of inertias that are more than `least` times the largest possible ones."""
    for each in found:
        ratio = each.values.get("ratio")
        mismatch = each.code is robot.INERTIA_GEOMETRY_MISMATCH
        if mismatch and isinstance(ratio, float) and ratio > least:
            yield each
