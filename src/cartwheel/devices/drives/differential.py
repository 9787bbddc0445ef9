"""Differential drive: pairs of left and right wheels, which turn the robot by their difference."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from cartwheel.component import Scope
from cartwheel.devices.drives.commanded_joint import CommandedJoint, Wheel
from cartwheel.devices.drives.drive import Drive, DriveConfig
from cartwheel.devices.drives.kinematics import rim_speeds
from cartwheel.devices.drives.limiter import NO_LIMITS, Limiter, Limits
from cartwheel.devices.drives.reckoning import DeadReckoning, Motion
from cartwheel.devices.elementwise import clamp
from cartwheel.devices.ramp import ramp


@dataclass(frozen=True, kw_only=True, slots=True)
class WheelPair:
    """Two wheels on one axle."""

    left: str
    """Joint of the left wheel."""
    right: str
    """Joint of the right wheel."""
    separation: float
    """Distance between the wheels, m."""
    left_radius: float
    """Radius of the left wheel, m."""
    right_radius: float
    """Radius of the right wheel, m."""


@dataclass(frozen=True, kw_only=True, slots=True)
class DifferentialDriveConfig:
    """Wheels, limits and odometry of a differential drive."""

    pairs: tuple[WheelPair, ...]
    """The wheels. The first pair's separation and radii are used for the odometry."""
    max_torque: float | None = None
    """Maximum torque of each wheel, N m; None: the joints' effort limits."""
    effort_limits: bool = True
    """Whether the joints' effort limits apply."""
    max_rim_speed: float = math.inf
    """Maximum commanded rim speed of the wheels, m/s."""
    acceleration: float = 0.0
    """Maximum acceleration of the wheels' commanded rim speed, m/s²; 0: no limit."""
    linear: Limits = NO_LIMITS
    """Limits on the forward velocity."""
    angular: Limits = NO_LIMITS
    """Limits on the yaw rate."""
    limit_period: float | None = None
    """Time between two commands for `linear` and `angular`, s; None: the measured time."""
    odometry: Literal["ground truth", "positions", "velocities", "commands"] = "ground truth"
    """Source of the odometry: the pose in the world, or dead reckoning from the wheels' positions
    or velocities, or from the limited commands."""
    measured_pairs: int | None = 1
    """Number of pairs whose mean rotation is measured; None: all."""
    drive: DriveConfig | None
    """Topics and rates; None: the owner passes commands, calls `measure` and `actuate`, and
    publishes."""


class DifferentialDrive(Drive):
    """Turns pairs of wheels so that the robot follows a forward velocity and a yaw rate.

    Args:
        scope: The robot and the names of topics.
        config: Wheels, limits and odometry.
        wheel_of: Returns the wheel of a joint. None: the drive requests a motor for each joint.
        yaw_rate: Returns the yaw rate in rad/s that a gyroscope measures; None: the odometry uses
            the wheels.
        reckoning: The estimate to update; None: a new one.

    Raises:
        UnknownNameError: A joint does not exist.
    """

    _limited: tuple[float, float]
    """The command within the limits."""
    _targets: list[float]
    """Rim speeds that follow from the command, m/s."""
    _speeds: list[float]
    """Rim speeds after the ramp, m/s."""
    _rotating: list[tuple[CommandedJoint, float]]
    """The wheels and their commands, rad/s."""
    _steady: tuple[tuple[float, float], float] | None
    """The command and the period for which the limiters changed nothing."""
    _rotation: tuple[float, float] | None
    """Mean rotation of the left and right wheels at the last update, rad."""

    def __init__(
        self,
        scope: Scope,
        config: DifferentialDriveConfig,
        *,
        wheel_of: Callable[[str], CommandedJoint] | None = None,
        yaw_rate: Callable[[], float] | None = None,
        reckoning: DeadReckoning | None = None,
    ) -> None:
        super().__init__(scope)
        self._config = config
        self._yaw_rate = yaw_rate
        wheel_of = wheel_of or self._motor_wheel
        # A wheel may be in several pairs if the sides have different numbers of wheels.
        left, right = functools.cache(wheel_of), functools.cache(wheel_of)
        self._wheels = [
            wheel for pair in config.pairs for wheel in (left(pair.left), right(pair.right))
        ]
        self._radii = [
            radius for pair in config.pairs for radius in (pair.left_radius, pair.right_radius)
        ]
        self._separations = [pair.separation for pair in config.pairs]
        count = config.measured_pairs
        states = [wheel.state for wheel in self._wheels]
        self._measured = list(zip(states[0::2], states[1::2], strict=True))[:count]
        """The left and right wheels whose rotation is measured."""
        self.linear, self.angular = Limiter(config.linear), Limiter(config.angular)
        # Without limits, a scheduled drive computes the wheels' speeds once for each command.
        self._is_limited = config.drive is None or not (
            config.linear == config.angular == NO_LIMITS
        )
        self._is_instant = config.linear.is_instant and config.angular.is_instant
        self._is_true = config.odometry == "ground truth"
        """Whether the odometry contains the pose in the world."""
        self._can_idle = self._is_true and not self._is_limited
        self.reckoning = DeadReckoning() if reckoning is None else reckoning
        self._rest()
        if config.drive is not None:
            self.run(config.drive, reads_state=yaw_rate is None)

    def reset(self) -> None:
        """Stops the wheels and forgets commands and odometry."""
        super().reset()
        self._rest()
        for wheel in self._wheels:
            wheel.command = 0.0

    def start(self) -> None:
        """Forgets commands and odometry, and measures distances from the wheels' rotation now."""
        self._rest()
        self._rotation = self._rotations()

    def command(self, forward: float, sideways: float, turn: float) -> None:  # noqa: ARG002
        self._command = (forward, turn)
        if not self._is_limited:
            self._set_targets(*self._command)

    def update(self, seconds: float) -> None:
        self.actuate(seconds)
        if not self._is_true:
            self.measure(seconds)

    def can_idle(self) -> bool:
        return self._can_idle

    def is_idle(self) -> bool:
        if self._updated_ns is None or self._speeds != self._targets:
            return False
        # Another plugin may have commanded a wheel. A loop takes a third of the time of `all`.
        for wheel, speed in self._rotating:  # noqa: SIM110
            if wheel.command != speed:
                return False
        return True

    def respond(self) -> None:
        # A wheel's ramp continues at the next update.
        if self._is_instant and not (self._is_limited and self._config.limit_period is None):
            self.actuate(0.0)

    def actuate(self, seconds: float) -> None:
        """Commands the wheels, `seconds` after the last call."""
        config = self._config
        if self._is_limited:
            command, steady = self._command, self._steady
            period = seconds if config.limit_period is None else config.limit_period
            if steady is None or command != steady[0] or period != steady[1]:
                forward, turn = command
                linear, angular = self.linear, self.angular
                forward, turn = linear.step(forward, period), angular.step(turn, period)
                if (forward, turn) != self._limited:
                    self._limited = (forward, turn)
                    self._set_targets(forward, turn)
                is_steady = linear.is_steady and angular.is_steady
                self._steady = (command, period) if is_steady else None
        if self._speeds is not self._targets:
            if config.acceleration > 0 and self._speeds != self._targets:
                most = config.acceleration * seconds
                self._speeds = [
                    speed if speed == target else ramp(speed, target, most)
                    for speed, target in zip(self._speeds, self._targets, strict=True)
                ]
            else:
                self._speeds = self._targets
            self._rotating = [
                (wheel, speed / radius)
                for wheel, speed, radius in zip(
                    self._wheels, self._speeds, self._radii, strict=True
                )
            ]
        for wheel, speed in self._rotating:
            wheel.command = speed

    def measure(self, seconds: float) -> None:
        """Adds the motion since the last call, `seconds` ago, to the dead reckoning."""
        source = self._config.odometry
        if source == "positions":
            before = self._rotation
            rotation = self._rotation = self._rotations()
            if before is None:
                return
            left, right = rotation[0] - before[0], rotation[1] - before[1]
        elif source == "velocities":
            left, right = (
                seconds * _mean([wheel.velocity for wheel in wheels])
                for wheels in zip(*self._measured, strict=True)
            )
        elif source == "ground truth":
            return
        if source == "commands":
            forward, turn = self.linear.value * seconds, self.angular.value * seconds
        else:
            # This is `axle_motion` inlined, because it runs at every step.
            pair = self._config.pairs[0]
            left, right = left * pair.left_radius, right * pair.right_radius
            forward, turn = (left + right) / 2, (right - left) / pair.separation
        if self._yaw_rate is not None:
            turn = self._yaw_rate() * seconds
        self.reckoning.go(forward, turn, seconds)

    @property
    def sides(self) -> tuple[float, float]:
        """Commanded rim speeds of the first pair's left and right wheel, m/s."""
        return self._speeds[0], self._speeds[1]

    def motion(self) -> Motion:
        return self._base.planar_motion() if self._is_true else self.reckoning.motion()

    def _rest(self) -> None:
        self._command = self._limited = (0.0, 0.0)
        self._targets = [0.0] * len(self._wheels)
        self._speeds = self._targets
        self._rotating = [(wheel, 0.0) for wheel in self._wheels]
        self._rotation = None
        self._steady = None
        self.linear.reset()
        self.angular.reset()
        self.reckoning.restart()

    def _set_targets(self, forward: float, turn: float) -> None:
        most = self._config.max_rim_speed
        targets = [
            speed
            for separation in self._separations
            for speed in rim_speeds(forward, turn, separation)
        ]
        if most < math.inf:
            targets = [clamp(speed, -most, most) for speed in targets]
        self._targets = targets

    def _rotations(self) -> tuple[float, float]:
        # This runs at every step, so it reads the positions without calls.
        measured = self._measured
        count = len(measured)
        if count == 1:
            left, right = measured[0]
            return left.qpos[left.qposadr], right.qpos[right.qposadr]
        left_sum = right_sum = 0.0
        for left, right in measured:
            left_sum += left.qpos[left.qposadr]
            right_sum += right.qpos[right.qposadr]
        return left_sum / count, right_sum / count

    def _motor_wheel(self, joint: str) -> CommandedJoint:
        config = self._config
        return Wheel(
            self.part,
            joint,
            max_effort=config.max_torque,
            limited=config.drive is not None and config.drive.limited_joints,
            beyond=not config.effort_limits,
            origin=self.origin,
        )


def _mean(values: list[float]) -> float:
    return sum(values) / len(values)
