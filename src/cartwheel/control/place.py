"""The pose of a model from command-line options."""

from __future__ import annotations

from collections.abc import Mapping

from cartwheel.geometry import Pose

AXES = ("x", "y", "z", "roll", "pitch", "yaw")
"""Metres and radians."""


def placed(pose: Pose, values: Mapping[str, float]) -> Pose | None:
    """The description's pose with some `AXES` replaced; None if no values are given."""
    if not values:
        return None
    own = dict(zip(AXES, (*pose.position, *pose.rpy), strict=True))
    x, y, z, roll, pitch, yaw = (float(values.get(axis, own[axis])) for axis in AXES)
    return Pose.from_xyz_rpy((x, y, z), (roll, pitch, yaw))
