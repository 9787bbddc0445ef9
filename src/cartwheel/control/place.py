"""Where a model is to stand, as a command line says it."""

from __future__ import annotations

from collections.abc import Mapping

from cartwheel.geometry import Pose

AXES = ("x", "y", "z", "roll", "pitch", "yaw")
"""Metres and radians."""


def placed(pose: Pose, values: Mapping[str, float]) -> Pose | None:
    """A description's own pose with the given ones of `AXES` in place of its; None without any."""
    if not values:
        return None
    own = dict(zip(AXES, (*pose.position, *pose.rpy), strict=True))
    x, y, z, roll, pitch, yaw = (float(values.get(axis, own[axis])) for axis in AXES)
    return Pose.from_xyz_rpy((x, y, z), (roll, pitch, yaw))
