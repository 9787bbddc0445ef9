"""Dead reckoning: the pose of a robot in the plane, estimated from the motion of its wheels."""

from __future__ import annotations

import math
from collections import deque
from typing import Protocol

from cartwheel.devices.drives.kinematics import PlanarPose, along_arc, axle_motion
from cartwheel.geometry import Quat, Vec3

Motion = tuple[Vec3, Quat, Vec3, Vec3]
"""Position in m, orientation, linear velocity in m/s, angular velocity in rad/s.

The pose is in the odometry frame, and the velocities are in the robot's frame.
"""


class Rotation(Protocol):
    """A joint whose position is measured."""

    @property
    def position(self) -> float:
        """rad."""


class DeadReckoning:
    """Estimates the pose and the velocity of a robot in the plane.

    Args:
        window: Number of motions over which the velocity is averaged. None: the velocity of the
            last motion is used.
    """

    def __init__(self, window: int | None = None) -> None:
        self._recent = None if window is None else deque[Vec3](maxlen=window)
        self.restart()

    def restart(self) -> None:
        """Resets the estimate to the origin, at rest."""
        self.pose: PlanarPose = (0.0, 0.0, 0.0)
        self._velocity = (0.0, 0.0, 0.0)
        if self._recent is not None:
            self._recent.clear()

    def go(self, forward: float, turn: float, seconds: float, *, sideways: float = 0.0) -> None:
        """Adds a motion along an arc: distance in m, rotation in rad, duration in s."""
        self.pose = along_arc(self.pose, forward, turn, sideways=sideways)
        if seconds > 0:
            self._velocity = (forward / seconds, sideways / seconds, turn / seconds)
            if self._recent is not None:
                self._recent.append(self._velocity)

    def motion(self) -> Motion:
        """Returns the estimated pose and velocity."""
        x, y, heading = self.pose
        half = heading / 2
        forward, sideways, turn_rate = self._velocity
        if self._recent is not None:
            count = max(len(self._recent), 1)
            forward, sideways, turn_rate = (
                sum(each[axis] for each in self._recent) / count for axis in range(3)
            )
        return (
            (x, y, 0.0),
            (0.0, 0.0, math.sin(half), math.cos(half)),
            (forward, sideways, 0.0),
            (0.0, 0.0, turn_rate),
        )


class AxleReckoning(DeadReckoning):
    """Dead reckoning from the rotation of the two wheels on an axle.

    Args:
        left: Joint of the left wheel.
        right: Joint of the right wheel.
        radius: Radius of both wheels, m.
        separation: Distance between the wheels, m.
    """

    def __init__(
        self, left: Rotation, right: Rotation, *, radius: float, separation: float
    ) -> None:
        self._left, self._right = left, right
        self._radius, self._separation = radius, separation
        super().__init__()
        self.begin()

    def begin(self) -> None:
        """Resets the estimate to the origin and ignores past rotation of the wheels."""
        self.restart()
        self._rotation: tuple[float, float] | None = None

    def read(self, seconds: float, *, turn: float | None = None) -> None:
        """Adds the motion of the wheels since the last call.

        Args:
            seconds: Time since the last call, s.
            turn: Rotation of the robot in rad, if a gyroscope measures it; None: computed from the
                wheels.
        """
        rotation = (self._left.position, self._right.position)
        if self._rotation is not None:
            left, right = (
                (now - before) * self._radius
                for now, before in zip(rotation, self._rotation, strict=True)
            )
            forward, by_wheels = axle_motion(left, right, self._separation)
            self.go(forward, by_wheels if turn is None else turn, seconds)
        self._rotation = rotation
