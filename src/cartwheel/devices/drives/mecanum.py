"""Drives with four mecanum wheels, which also move the robot sideways."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, Literal

from cartwheel.codes import robot
from cartwheel.component import Scope
from cartwheel.description.rolling import FORWARD, Rolling, rolling
from cartwheel.devices.drives.commanded_joint import CommandedJoint, Wheel
from cartwheel.devices.drives.drive import Drive, DriveConfig
from cartwheel.devices.drives.limiter import Limiter, Limits
from cartwheel.devices.drives.reckoning import DeadReckoning, Motion
from cartwheel.devices.drives.rollers import BACKWARD, has_grip, has_rollers
from cartwheel.devices.elementwise import Number, cos, sin
from cartwheel.geometry import Vec3
from cartwheel.simulation.dynamics.external_servos import BodyDriveHandle

Velocity = tuple[Number, Number, Number]
"""Forward and sideways velocity, m/s, and yaw rate, rad/s; or distances, m, and a rotation, rad."""
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
    limits: tuple[Limits, Limits, Limits]
    """Limits on the forward and sideways velocity and on the yaw rate."""
    offset: Vec3 | None = None
    """Pose of the base frame, which the commands and the odometry describe, relative to the wheels'
    centre: x and y, m, and yaw, rad. None: both are equal."""
    rolling: Rolling = FORWARD
    """How the wheels roll."""
    subtracts: Literal["rotations", "distances"] = "rotations"
    """What is subtracted to obtain the motion in a time step: the rotations of the wheels, or the
    distances that they rolled. The results differ only in rounding."""


class MecanumWheels:
    """Turns four mecanum wheels and estimates the robot's pose from their rotation.

    Args:
        config: Dimensions and limits.
        wheels: The wheels at each corner. The first wheel of a corner is measured.
        servo: Pushes a robot whose wheels do not model rollers; see `has_rollers`.
        reckoning: The estimate.
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
        self._reckoning = reckoning
        self._limiters = [Limiter(limits) for limits in config.limits]
        self._positions: list[float] | None = None

    def restart(self) -> None:
        """Restarts the estimate at the origin, and forgets limited commands."""
        self._positions = None
        self._reckoning.restart()
        for limiter in self._limiters:
            limiter.reset()

    def command(self, wanted: Vec3, seconds: float) -> Vec3:
        """Commands the wheels.

        Args:
            wanted: Forward and sideways velocity of the base frame, m/s, and yaw rate, rad/s.
            seconds: Time since the last command, s.

        Returns:
            The limited command.
        """
        forward, sideways, turn = (
            limiter.step(value, seconds)
            for limiter, value in zip(self._limiters, wanted, strict=True)
        )
        self.push(forward, sideways, turn)
        config = self._config
        center = (forward, sideways, turn)
        if config.offset is not None:
            center = at_center(center, config.offset)
        for wheels, speed in zip(self._wheels, wheel_speeds(*center, config.reach), strict=True):
            for wheel in wheels:
                wheel.command = speed / config.radius
        return forward, sideways, turn

    def measure(self, seconds: float) -> None:
        """Updates the estimate from the rotation in the last `seconds`.

        The first call after a restart only measures the positions of the wheels.
        """
        config = self._config
        early, late = (
            (config.radius, 1.0) if config.subtracts == "distances" else (1.0, config.radius)
        )
        positions = [wheels[0].position * early for wheels in self._wheels]
        if self._positions is not None:
            front_left, front_right, back_left, back_right = (
                (now - before) * late
                for now, before in zip(positions, self._positions, strict=True)
            )
            motion = wheels_motion((front_left, front_right, back_left, back_right), config.reach)
            if config.offset is not None:
                motion = at_base(motion, config.offset)
            forward, sideways, turn = motion
            self._reckoning.go(forward, turn, seconds, sideways=sideways)
        self._positions = positions

    def stop(self) -> None:
        """Stops the wheels and the robot immediately."""
        for wheels in self._wheels:
            for wheel in wheels:
                wheel.command = 0.0
        self.push(0.0, 0.0, 0.0)

    def push(self, forward: float, sideways: float, turn: float) -> None:
        """Pushes a robot without rollers at velocities in m/s and rad/s."""
        if self._servo is not None:
            wheels = self._config.rolling
            if wheels.backward:
                forward, sideways, turn = -forward, -sideways, -turn
            if heading := wheels.heading:
                cos, sin = math.cos(heading), math.sin(heading)
                forward, sideways = cos * forward - sin * sideways, sin * forward + cos * sideways
            self._servo.command((forward, sideways, None), (None, None, turn))


@dataclass(frozen=True, kw_only=True, slots=True)
class MecanumDriveConfig:
    front_left: tuple[str, ...]
    """Joints of the front left wheels."""
    front_right: tuple[str, ...]
    """Joints of the front right wheels."""
    back_left: tuple[str, ...]
    """Joints of the back left wheels."""
    back_right: tuple[str, ...]
    """Joints of the back right wheels."""
    wheels: MecanumWheelsConfig
    """Dimensions and limits."""
    drive: DriveConfig
    """Topics and rates."""


class MecanumDrive(Drive):
    """Drives mecanum wheels from Twist commands and publishes odometry from their rotation.

    A servo pushes robots whose wheels have friction but do not model rollers.

    Raises:
        UnknownNameError: A joint does not exist.
    """

    sideways: ClassVar[bool] = True

    def __init__(self, scope: Scope, config: MecanumDriveConfig) -> None:
        super().__init__(scope)
        part, origin = self.part, self.origin
        corners = (config.front_left, config.front_right, config.back_left, config.back_right)
        pushes = not has_rollers(part.description) and has_grip(
            part.description, [name for names in corners for name in names]
        )
        # A base that is pushed is as fast as it is commanded, so its wheels must be, too.
        limited = config.drive.limited_joints and not pushes
        wheels = [
            [Wheel(part, name, max_effort=None, limited=limited, origin=origin) for name in names]
            for names in corners
        ]
        servo = part.body_drive(origin=origin) if pushes else None
        self._reckoning = DeadReckoning()
        found = rolling(
            part.description,
            (*config.front_left, *config.back_left),
            (*config.front_right, *config.back_right),
        )
        if found.backward:
            joint = config.front_left[0] if config.front_left else ""
            values = {"joint": joint, "attribute": "backwards"}
            self.warn(robot.WHEEL_AXIS_MISALIGNED, BACKWARD, values=values)
        dimensions = replace(config.wheels, rolling=found)
        self._wheels = MecanumWheels(dimensions, wheels, servo, self._reckoning)
        self._period = 1 / config.drive.control_rate
        self._is_instant = all(each.is_instant for each in config.wheels.limits)
        self.run(config.drive, reads_state=True)

    def reset(self) -> None:
        super().reset()
        self._command = (0.0, 0.0, 0.0)
        self._wheels.restart()
        self._wheels.push(*self._command)

    def command(self, forward: float, sideways: float, turn: float) -> None:
        self._command = (forward, sideways, turn)

    def update(self, seconds: float) -> None:
        self._wheels.command(self._command, self._period)
        self._wheels.measure(seconds)

    def respond(self) -> None:
        if self._is_instant:
            self._wheels.command(self._command, self._period)

    def motion(self) -> Motion:
        return self._reckoning.motion()
