"""Driven and steered wheels that are commanded at the rate of their owner, without topics."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from cartwheel.devices.drives.commanded_joint import CommandedJoint
from cartwheel.devices.drives.limiter import Limiter, Limits
from cartwheel.devices.drives.reckoning import DeadReckoning
from cartwheel.devices.drives.steering import (
    alignment,
    angle_of_turn_in_place,
    axle_speed,
    driven_wheel_motion,
    driven_wheel_speed,
    middle_angle,
    rim_factors_in_place,
    wheel_angles_in_place,
)
from cartwheel.devices.elementwise import Number, clamp, tan
from cartwheel.devices.ramp import ramp

Axle = Sequence[CommandedJoint]
"""One wheel or steering joint in the middle, or the left and the right one."""


def mean_position(axle: Axle) -> float:
    """Returns the mean position of the joints, rad."""
    return sum(joint.position for joint in axle) / len(axle)


def mean_velocity(axle: Axle) -> float:
    """Returns the mean velocity of the joints, rad/s."""
    return sum(joint.velocity for joint in axle) / len(axle)


@dataclass(frozen=True, kw_only=True, slots=True)
class SteeredAxleConfig:
    wheel_base: float
    """Distance between the axles, m."""
    driven_track: float
    """Distance between two driven wheels, m."""
    steered_track: float
    """Distance between two steered wheels, m."""
    radius: float
    """Radius of the driven wheels, m."""
    measures: Literal["positions", "velocities", "nothing"]
    """What the estimated motion is computed from: the positions or the velocities of the driven
    wheels, or nothing but the commands."""


class SteeredAxle:
    """One axle that is driven and one that is steered, which follow a velocity and a yaw rate.

    Args:
        config: Dimensions.
        driven: Driven wheels.
        steering: Steering joints.
        reckoning: The estimate of the robot's pose.
    """

    def __init__(
        self, config: SteeredAxleConfig, driven: Axle, steering: Axle, reckoning: DeadReckoning
    ) -> None:
        self._config = config
        self._driven, self._steering = driven, steering
        self._reckoning = reckoning

    def restart(self) -> None:
        """Restarts the estimate at the origin, at rest."""
        self._reckoning.restart()
        self._position = mean_position(self._driven)
        self._commanded = (0.0, 0.0)

    def measure(self, seconds: float) -> None:
        """Updates the estimate by the motion in the last `seconds`."""
        config = self._config
        if config.measures == "nothing":
            forward, turn = self._commanded
            self._reckoning.go(forward * seconds, turn * seconds, seconds)
            return
        position = mean_position(self._driven)
        distance = (position - self._position) * config.radius
        self._position = position
        if config.measures == "velocities":
            distance = mean_velocity(self._driven) * config.radius * seconds
        sides = (0,) if len(self._steering) == 1 else (-1, 1)
        tangents = (
            tan(middle_angle(joint.position, config.wheel_base, config.steered_track, side))
            for joint, side in zip(self._steering, sides, strict=True)
        )
        tangent = sum(tangents) / len(self._steering)
        self._reckoning.go(distance, distance * tangent / config.wheel_base, seconds)

    def command(self, forward: float, turn: float) -> None:
        """Commands the joints for a velocity in m/s and a yaw rate in rad/s."""
        config, base = self._config, self._config.wheel_base
        self._commanded = (forward, turn)
        middle = angle_of_turn_in_place(forward, turn, base)
        speed = axle_speed(forward, turn, base, config.radius)
        angles: tuple[Number, ...] = (middle,)
        speeds: tuple[Number, ...] = (speed,)
        if len(self._steering) == 2:
            angles = wheel_angles_in_place(middle, base, config.steered_track)
        if len(self._driven) == 2:
            factors = rim_factors_in_place(middle, base, config.driven_track)
            speeds = (speed * factors[0], speed * factors[1])
        for joint, angle in zip(self._steering, angles, strict=True):
            joint.command = angle
        for wheel, each in zip(self._driven, speeds, strict=True):
            wheel.command = each

    def stop(self) -> None:
        """Stops the wheels immediately. The steering angles stay."""
        for wheel in self._driven:
            wheel.command = 0.0


@dataclass(frozen=True, kw_only=True, slots=True)
class SteeredByAngleConfig:
    wheel_base: float
    """Distance between the axles, m."""
    radius: float
    """Radius of the driven wheel, m."""
    speed_limits: Limits
    """Limits on the velocity."""
    angle_limits: Limits
    """Limits on the steering angle: its size, rad, its rate, rad/s, and so on."""
    angle_factor: float = 1.0
    """Measured steering angle per position of the steering joint."""
    open_loop: bool = False
    """Compute the estimated motion from the commands, not from the joints."""


class SteeredByAngle:
    """One driven wheel and one steering joint, which follow a velocity and a steering angle.

    Args:
        config: Dimensions and limits.
        driven: The driven wheel.
        steering: The steering joint of the other axle.
        reckoning: The estimate of the robot's pose.
    """

    def __init__(
        self,
        config: SteeredByAngleConfig,
        driven: CommandedJoint,
        steering: CommandedJoint,
        reckoning: DeadReckoning,
    ) -> None:
        self._config = config
        self._driven, self._steering = driven, steering
        self._reckoning = reckoning
        self._speed, self._angle = Limiter(config.speed_limits), Limiter(config.angle_limits)

    def restart(self) -> None:
        """Restarts the estimate at the origin, at rest, and forgets limited commands."""
        self._reckoning.restart()
        self._speed.reset()
        self._angle.reset()
        self._position = self._driven.position

    def measure(self, seconds: float) -> None:
        """Updates the estimate by the motion in the last `seconds`."""
        config = self._config
        angle = self._steering.position * config.angle_factor
        position = self._driven.position
        distance = (position - self._position) * config.radius
        self._position = position
        if config.open_loop:
            distance, angle = self._speed.value * seconds, self._angle.value
        self._reckoning.go(distance, distance * tan(angle) / config.wheel_base, seconds)

    def command(self, speed: float, angle: float, seconds: float) -> None:
        """Commands the joints, `seconds` after the last command.

        Args:
            speed: Velocity, m/s.
            angle: Steering angle, rad.
            seconds: Time since the last command, s.
        """
        self._driven.command = self._speed.step(speed, seconds) / self._config.radius
        self._steering.command = self._angle.step(angle, seconds)

    def turned(self, speed: float, angle: float) -> float:
        """The yaw rate at a velocity in m/s and an angle of the steering joint in rad, rad/s."""
        slope: float = tan(angle * self._config.angle_factor)
        return speed * slope / self._config.wheel_base

    def stop(self) -> None:
        """Stops the wheel immediately. The steering angle stays."""
        self._driven.command = 0.0


@dataclass(frozen=True, kw_only=True, slots=True)
class SteeredWheelConfig:
    wheel_base: float
    """Distance between the wheel and the other axle, m."""
    radius: float
    """Radius of the wheel, m."""
    speed_limits: Limits
    """Limits on the speed of the wheel, rad/s."""
    steering_rate: float = math.inf
    """Maximum steering rate, rad/s."""
    steering_range: tuple[float, float] = (-math.inf, math.inf)
    """Minimum and maximum steering angle, rad."""
    open_loop: bool = False
    """Compute the estimated motion from the commands, not from the joints."""


class SteeredWheel:
    """A wheel that is both driven and steered, and follows a velocity and a yaw rate.

    Args:
        config: Dimensions and limits.
        wheel: The wheel.
        steering: The joint that steers the wheel.
        reckoning: The estimate of the robot's pose.
    """

    def __init__(
        self,
        config: SteeredWheelConfig,
        wheel: CommandedJoint,
        steering: CommandedJoint,
        reckoning: DeadReckoning,
    ) -> None:
        self._config = config
        self._wheel, self._steering = wheel, steering
        self._reckoning = reckoning
        self._limiter = Limiter(config.speed_limits)

    def restart(self) -> None:
        """Restarts the estimate at the origin, at rest, and forgets limited commands."""
        self._reckoning.restart()
        self._limiter.reset()
        self._angle = self._steering.position
        self._position = self._wheel.position
        self._commanded = (0.0, 0.0)

    def measure(self, seconds: float) -> None:
        """Updates the estimate by the motion in the last `seconds`."""
        config = self._config
        position = self._wheel.position
        rolled = (position - self._position) * config.radius
        self._position = position
        if config.open_loop:
            forward, turn = (value * seconds for value in self._commanded)
        else:
            forward, turn = driven_wheel_motion(rolled, self._steering.position, config.wheel_base)
        self._reckoning.go(forward, turn, seconds)

    def command(self, forward: float, turn: float, seconds: float) -> None:
        """Commands the joints.

        Args:
            forward: Velocity of the other axle, m/s.
            turn: Yaw rate, rad/s.
            seconds: Time since the last command, s.
        """
        config, base = self._config, self._config.wheel_base
        self._commanded = (forward, turn)
        angle = clamp(angle_of_turn_in_place(forward, turn, base), *config.steering_range)
        speed = driven_wheel_speed(forward, turn, angle, base, config.radius)
        speed *= alignment(angle - self._steering.position)
        self._wheel.command = self._limiter.step(speed, seconds)
        self._angle = ramp(self._angle, angle, config.steering_rate * seconds)
        self._steering.command = self._angle

    def stop(self) -> None:
        """Stops the wheel immediately. The steering angle stays."""
        self._wheel.command = 0.0
