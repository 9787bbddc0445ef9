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
_Step = tuple[float, float, float, float]
"""A motion along an arc: distances along x and y in m, rotation in rad, duration in s."""
_TOGETHER = 64
"""Number of motions that are added together, unless the estimate is read before. Each of them then
takes half of the time that it takes alone, between two steps of the physics."""


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
        self._averages = window is not None
        self._moved = deque[_Step](maxlen=window or 1)
        """The last motions, from which the velocity is computed."""
        self.restart()

    def restart(self) -> None:
        """Resets the estimate to the origin, at rest."""
        self._pose: PlanarPose = (0.0, 0.0, 0.0)
        self._moved.clear()
        self._pending: list[_Step] = []
        """Motions that the estimate does not contain yet."""

    def go(self, forward: float, turn: float, seconds: float, *, sideways: float = 0.0) -> None:
        """Adds a motion along an arc: distance in m, rotation in rad, duration in s."""
        pending = self._pending
        pending.append((forward, sideways, turn, seconds))
        if len(pending) >= _TOGETHER:
            self._go_on()

    @property
    def pose(self) -> PlanarPose:
        """The estimated pose."""
        if self._pending:
            self._go_on()
        return self._pose

    def _go_on(self) -> None:
        """Adds the pending motions to the estimate."""
        pose, moved = self._pose, self._moved
        for motion in self._pending:
            forward, sideways, turn, seconds = motion
            pose = along_arc(pose, forward, turn, sideways)
            if seconds > 0:
                moved.append(motion)
        self._pose = pose
        self._pending.clear()

    def motion(self) -> Motion:
        """Returns the estimated pose and velocity."""
        x, y, heading = self.pose
        half = heading / 2
        velocities = [
            (forward / seconds, sideways / seconds, turn / seconds)
            for forward, sideways, turn, seconds in self._moved
        ]
        forward, sideways, turn_rate = velocities[-1] if velocities else (0.0, 0.0, 0.0)
        if self._averages:
            count = max(len(velocities), 1)
            forward, sideways, turn_rate = (
                sum(each[axis] for each in velocities) / count for axis in range(3)
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
