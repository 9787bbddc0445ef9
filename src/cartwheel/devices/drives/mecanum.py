"""Drives with four mecanum wheels, which also move the robot sideways."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from cartwheel.component import Scope
from cartwheel.devices.drives.commanded_joint import CommandedJoint, Wheel
from cartwheel.devices.drives.drive import Drive, DriveConfig
from cartwheel.devices.drives.limiter import Limiter, Limits
from cartwheel.devices.drives.reckoning import DeadReckoning, Motion
from cartwheel.devices.drives.rollers import has_rollers
from cartwheel.devices.elementwise import Number, cos, sin
from cartwheel.geometry import Vec3
from cartwheel.simulation.pushing import BodyDriveHandle

Velocity = tuple[Number, Number, Number]
"""Forward and sideways velocity, m/s, and yaw rate, rad/s. Or the motion during a time, m and rad."""
Corners = tuple[Number, Number, Number, Number]
"""A value for each wheel: front left, front right, back left, back right."""


def wheel_speeds(forward: Number, sideways: Number, turn: Number, reach: Number) -> Corners:
    """Returns the rim speeds of the wheels, m/s.

    Args:
        forward: Velocity along x, m/s.
        sideways: Velocity along y, m/s.
        turn: Yaw rate, rad/s.
        reach: Half the sum of the wheel base and the track, m.
    """
    around = reach * turn
    return (
        forward - sideways - around,
        forward + sideways + around,
        forward + sideways - around,
        forward - sideways + around,
    )


def wheels_motion(rolled: Corners, reach: Number) -> Velocity:
    """Returns the motion of the wheels' centre from the distances in m that the wheels rolled.

    Args:
        rolled: Distances, m, or rim speeds, m/s.
        reach: Half the sum of the wheel base and the track, m.
    """
    front_left, front_right, back_left, back_right = rolled
    return (
        (front_left + front_right + back_left + back_right) / 4,
        (-front_left + front_right + back_left - back_right) / 4,
        (-front_left + front_right - back_left + back_right) / 4 / reach,
    )


def at_center(base: Velocity, offset: Vec3) -> Velocity:
    """Returns the motion of the wheels' centre for a motion of the base frame.

    Args:
        base: Motion of the base frame.
        offset: Pose of the base frame relative to the wheels' centre: x and y, m, and yaw, rad.
    """
    x, y, yaw = offset
    forward, sideways, turn = base
    c, s = cos(yaw), sin(yaw)
    return c * forward - s * sideways + y * turn, s * forward + c * sideways - x * turn, turn


def at_base(center: Velocity, offset: Vec3) -> Velocity:
    """Returns the motion of the base frame for a motion of the wheels' centre; see `at_center`."""
    x, y, yaw = offset
    forward, sideways, turn = center
    forward, sideways = forward - y * turn, sideways + x * turn
    c, s = cos(yaw), sin(yaw)
    return c * forward + s * sideways, c * sideways - s * forward, turn


@dataclass(frozen=True, kw_only=True, slots=True)
class MecanumWheelsConfig:
    radius: float
    """Radius of all wheels, m."""
    reach: float
    """Half the sum of the wheel base and the track, m."""
    limits: tuple[Limits, Limits, Limits] = field(default=(Limits(), Limits(), Limits()))
    """Limits on the forward and sideways velocity and on the yaw rate."""
    offset: Vec3 | None = None
    """Pose of the base frame, which the commands and the odometry describe, relative to the wheels'
    centre: x and y, m, and yaw, rad. None: both are equal."""
    subtracts: str = "rotations"
    """Measure a rolled distance from the difference of two rotations, ``rotations``, or as the
    difference of two distances, ``distances``. The results differ in rounding."""


class MecanumWheels:
    """Turns four mecanum wheels and estimates the robot's pose from their rotation.

    Args:
        config: Dimensions and limits.
        wheels: The wheels at each corner. The first of them is measured.
        servo: Pushes a robot whose wheels do not model rollers; see `has_rollers`.
    """

    def __init__(
        self,
        config: MecanumWheelsConfig,
        wheels: Sequence[Sequence[CommandedJoint]],
        servo: BodyDriveHandle | None,
        reckoning: DeadReckoning,
    ) -> None:
        self._config = config
        self._wheels = wheels
        self._servo = servo
        self.reckoning = reckoning
        self._limiters = [Limiter(limits) for limits in config.limits]
        self.restart()
