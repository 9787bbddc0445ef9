"""The motion of a model that is fixed to the world."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from cartwheel.geometry import Pose, Vec3, quat_multiply

_STILL: Vec3 = (0.0, 0.0, 0.0)


@dataclass(frozen=True, kw_only=True, slots=True)
class Motion:
    """A constant velocity from a pose on.

    The pose is computed from the time, so it does not depend on how the time is divided into steps.
    """

    pose: Pose
    """Pose of the model's frame at `time_ns`."""
    time_ns: int
    """Simulation time at which it begins."""
    linear: Vec3 = _STILL
    """Velocity of the frame's origin, m/s, in world axes."""
    angular: Vec3 = _STILL
    """rad/s, in world axes."""

    def at(self, time_ns: int) -> Pose:
        """The pose of the model's frame at a time."""
        seconds = (time_ns - self.time_ns) * 1e-9
        x, y, z = (np.array(self.pose.position) + seconds * np.array(self.linear)).tolist()
        rate = math.hypot(*self.angular)
        if not rate:
            return Pose((x, y, z), self.pose.orientation)
        half = rate * seconds / 2
        ax, ay, az = (each / rate * math.sin(half) for each in self.angular)
        turn = quat_multiply((ax, ay, az, math.cos(half)), self.pose.orientation)
        return Pose((x, y, z), turn)
