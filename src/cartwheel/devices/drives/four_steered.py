"""Four driven wheels that are all steered, on two axles."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from cartwheel.devices.drives.commanded_joint import CommandedJoint
from cartwheel.devices.drives.limiter import Limiter, Limits
from cartwheel.devices.drives.reckoning import DeadReckoning

_STANDS = 1e-3
"""Velocity in m/s up to which the wheels do not turn."""
_STRAIGHT = 1e-3
"""Angles of both wheels in rad up to which an axle counts as straight."""
_PARALLEL = 1e-2
"""Difference of two tangents up to which the wheels of an axle count as parallel."""

Pair = tuple[float, float]
"""A value for the left and one for the right wheel of an axle."""


class Axles(NamedTuple):
    """What the four wheels do."""

    front_speeds: Pair
    """Speeds of the wheels, rad/s."""
    rear_speeds: Pair
    front_angles: Pair
    """Steering angles, rad."""
    rear_angles: Pair


class AxleMotion(NamedTuple):
    """A motion of the robot, from the rotation of its wheels."""

    forward: float
    """m/s."""
    sideways: float
    """m/s, to the left."""
    turn: float
    """rad/s."""
    front: float
    """Steering angle of an imaginary wheel in the middle of the front axle, rad."""
    rear: float
    """The same of the rear axle, rad."""


@dataclass(frozen=True, kw_only=True, slots=True)
class FourSteeredConfig:
    wheel_base: float
    """Distance between the axles, m."""
    track: float
    """Distance between the steering axes of an axle, m."""
    offset: float
    """Distance of a wheel from its steering axis, outwards, m."""
    radius: float
    """Radius of the wheels, m."""
    speed_limits: Limits
    """Limits on the velocity."""
    turn_limits: Limits
    """Limits on the yaw rate."""
    window: int
    """Number of measurements over which accelerations and steering rates are averaged."""


def axles_of_turn(config: FourSteeredConfig, forward: float, turn: float) -> Axles:
    """Returns what the wheels do for a velocity in m/s and a yaw rate in rad/s.

    The axles are steered in opposite directions. The robot does not turn in place. Source:
    four_wheel_steering_controller of ros_controllers.
    """
    half = turn * config.track / 2
    lateral = turn * config.wheel_base / 2
    stands = abs(forward) <= _STANDS
    left = right = 0.0
    if abs(forward) > abs(half):
        left, right = math.atan(lateral / (forward - half)), math.atan(lateral / (forward + half))
    elif not stands:
        left = right = math.copysign(math.pi / 2, turn)
    speeds = (0.0, 0.0) if stands else _wheel_speeds(config, forward, turn, lateral)
    return Axles(speeds, speeds, (left, right), (-left, -right))


def axles_of_angles(config: FourSteeredConfig, speed: float, front: float, rear: float) -> Axles:
    """Returns what the wheels do for a velocity in m/s and the steering angle of each axle in rad.

    If both angles are equal, the robot does not turn, and `speed` is that along the wheels. Source:
    four_wheel_steering_controller of ros_controllers.
    """
    base, right_angle = config.wheel_base, math.pi / 2
    tangents = [math.tan(min(max(each, -right_angle), right_angle)) for each in (front, rear)]
    difference = tangents[0] - tangents[1]
    half = config.track / 2 * difference
    angles, speeds = [], []
    turn = speed * difference / base
    for tangent in tangents:
        left = right = 0.0
        if abs(base - abs(half)) > _STANDS:
            left = math.atan(base * tangent / (base - half))
            right = math.atan(base * tangent / (base + half))
        angles.append((left, right))
        parallel = abs(math.tan(left) - math.tan(right)) <= _PARALLEL
        lateral = 0.0 if parallel else speed * tangent
        stands = abs(speed) <= _STANDS
        speeds.append((0.0, 0.0) if stands else _wheel_speeds(config, speed, turn, lateral))
    return Axles(speeds[0], speeds[1], angles[0], angles[1])


def _wheel_speeds(config: FourSteeredConfig, forward: float, turn: float, lateral: float) -> Pair:
    """Speeds of the wheels of an axle whose middle moves forward and sideways in m/s, rad/s."""
    half, more = turn * config.track / 2, turn * config.offset
    left = math.copysign(math.hypot(forward - half, lateral), forward) - more
    right = math.copysign(math.hypot(forward + half, lateral), forward) + more
    return left / config.radius, right / config.radius


def motion_of_axles(config: FourSteeredConfig, axles: Axles) -> AxleMotion:
    """Returns the motion of the middle between the axles.

    Each axle results in a velocity, and the mean of both is returned. The velocity of an axle is
    the one with which the squares of its wheels' speeds have their sum.
    """
    front, rear = _middle(axles.front_angles), _middle(axles.rear_angles)
    difference = math.tan(front) - math.tan(rear)
    forward = sideways = turn = 0.0
    for angle, speeds in ((front, axles.front_speeds), (rear, axles.rear_speeds)):
        # Yaw rate per velocity of the axle's middle, 1/m.
        curve = math.cos(angle) * difference / config.wheel_base
        velocity = _axle_velocity(config, angle, curve, speeds)
        forward += velocity * math.cos(angle) / 2
        sideways += velocity * math.sin(angle) / 2
        turn += velocity * curve / 2
    return AxleMotion(forward, sideways, turn, front, rear)


def _middle(angles: Pair) -> float:
    """Steering angle of an imaginary wheel between two wheels of an axle, rad."""
    if max(abs(each) for each in angles) <= _STRAIGHT:
        return 0.0
    left, right = (math.tan(each) for each in angles)
    total = left + right
    return math.atan(2 * left * right / total) if total else 0.0


def _axle_velocity(config: FourSteeredConfig, angle: float, curve: float, speeds: Pair) -> float:
    """Velocity of the middle of an axle along its imaginary wheel, m/s."""
    half = config.track * curve / 2
    found = []
    for speed, side in zip(speeds, (-1, 1), strict=True):
        # Velocity of the steering axis per velocity of the middle; the wheel is further outwards.
        ratio = math.sqrt(max(1 + 2 * side * half * math.cos(angle) + half * half, 0.0))
        along = ratio + side * config.offset * curve
        found.append(speed * config.radius * (ratio / along if along > 0 else 1.0))
    size = math.sqrt((found[0] ** 2 + found[1] ** 2) / (2 + 2 * half * half))
    return math.copysign(size, found[0] + found[1])


class FourSteeredWheels:
    """Drives and steers four wheels, and estimates the robot's pose from their motion.

    Args:
        config: Dimensions and limits.
        wheels: Driven wheels: front left, front right, rear left, rear right.
        steering: Steering joints in the same order.
        reckoning: The estimate.
    """

    def __init__(
        self,
        config: FourSteeredConfig,
        wheels: Sequence[CommandedJoint],
        steering: Sequence[CommandedJoint],
        reckoning: DeadReckoning,
    ) -> None:
        self._config = config
        self._wheels, self._steering = wheels, steering
        self._reckoning = reckoning
        self._speed, self._turn = Limiter(config.speed_limits), Limiter(config.turn_limits)
        self.motion = AxleMotion(0.0, 0.0, 0.0, 0.0, 0.0)
        """The measured motion."""
        self._rates = {name: deque[float](maxlen=config.window) for name in _RATES}

    def restart(self) -> None:
        """Restarts the estimate at the origin, at rest, and forgets limited commands."""
        self._reckoning.restart()
        self._speed.reset()
        self._turn.reset()
        self.motion = self._measured()
        self._last: dict[str, float] = dict.fromkeys(_RATES, 0.0)
        for each in self._rates.values():
            each.clear()

    def measure(self, seconds: float) -> None:
        """Updates the estimate by the motion in the last `seconds`."""
        motion = self.motion = self._measured()
        self._reckoning.go(
            motion.forward * seconds,
            motion.turn * seconds,
            seconds,
            sideways=motion.sideways * seconds,
        )
        if seconds <= 0:
            return
        now = {"acceleration": self.speed, "front": motion.front, "rear": motion.rear}
        for name in ("acceleration", "front", "rear"):
            self._note(name, now[name], seconds)
        self._note("jerk", self.rate("acceleration"), seconds)

    def _note(self, name: str, value: float, seconds: float) -> None:
        self._rates[name].append((value - self._last[name]) / seconds)
        self._last[name] = value

    @property
    def speed(self) -> float:
        """Size of the measured velocity, m/s; negative while the robot moves back."""
        motion = self.motion
        return math.copysign(math.hypot(motion.forward, motion.sideways), motion.forward)

    def rate(self, name: str) -> float:
        """Returns the mean of the last ``acceleration`` in m/s² or ``jerk`` in m/s³, or of the
        steering rate of the ``front`` or ``rear`` axle in rad/s.
        """
        values = self._rates[name]
        return sum(values) / len(values) if values else 0.0

    def command(self, forward: float, turn: float, seconds: float) -> None:
        """Commands a velocity in m/s and a yaw rate in rad/s; `seconds` since the last command."""
        forward, turn = self._speed.step(forward, seconds), self._turn.step(turn, seconds)
        self._apply(axles_of_turn(self._config, forward, turn))

    def command_angles(self, speed: float, front: float, rear: float, seconds: float) -> None:
        """Commands a velocity in m/s and the steering angles of both axles in rad."""
        speed = self._speed.step(speed, seconds)
        self._apply(axles_of_angles(self._config, speed, front, rear))

    def stop(self) -> None:
        """Stops the wheels immediately, and steers straight ahead."""
        self._apply(Axles((0.0, 0.0), (0.0, 0.0), (0.0, 0.0), (0.0, 0.0)))

    def _measured(self) -> AxleMotion:
        a, b, c, d = (wheel.velocity for wheel in self._wheels)
        e, f, g, h = (joint.position for joint in self._steering)
        return motion_of_axles(self._config, Axles((a, b), (c, d), (e, f), (g, h)))

    def _apply(self, axles: Axles) -> None:
        speeds = (*axles.front_speeds, *axles.rear_speeds)
        for wheel, speed in zip(self._wheels, speeds, strict=True):
            wheel.command = speed
        angles = (*axles.front_angles, *axles.rear_angles)
        for joint, angle in zip(self._steering, angles, strict=True):
            joint.command = angle


_RATES = ("acceleration", "jerk", "front", "rear")
