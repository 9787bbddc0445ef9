"""A car: driven wheels on one axle and two steered wheels on the other."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from cartwheel.component import Scope
from cartwheel.devices.drives.commanded_joint import Wheel
from cartwheel.devices.drives.drive import Drive, DriveConfig
from cartwheel.devices.drives.limiter import Limiter, Limits
from cartwheel.devices.drives.reckoning import AxleReckoning, Motion
from cartwheel.devices.drives.steering import angle_of_turn, rim_factors, wheel_angles
from cartwheel.devices.elementwise import Number, clamp, copysign, tan
from cartwheel.devices.joints.limits import velocity_limit
from cartwheel.messages import message_class
from cartwheel.simulation.dynamics.joint_servo import ServoHandle

_FIRST_PERIOD = 0.01
"""Duration of the first time step, in which the limits apply, s."""


@dataclass(frozen=True, kw_only=True, slots=True)
class AckermannDriveConfig:
    left: tuple[str, ...]
    """Joints of the driven left wheels."""
    right: tuple[str, ...]
    """Joints of the driven right wheels."""
    steering_left: str
    """Joint that steers the left wheel."""
    steering_right: str
    """Joint that steers the right wheel."""
    radius: float
    """Radius of the driven wheels, m."""
    wheel_base: float
    """Distance between the axles, m."""
    driven_track: float
    """Distance between the driven wheels, m."""
    steered_track: float
    """Distance between the steering axes, m."""
    max_steering: float
    """Maximum steering angle of the middle of the steered axle, rad."""
    turn: Literal["steering angle", "yaw rate"]
    """Meaning of ``angular.z``: the steering angle in rad, whose sign is inverted while the car
    reverses, or the yaw rate in rad/s."""
    speed_limits: Limits
    """Limits on the velocity."""
    turn_limits: Limits
    """Limits on ``angular.z``."""
    steering_first: bool = False
    """Whether the motors of the steering joints precede those of the wheels in the physics model.
    The order only affects rounding."""
    encoded: bool = False
    """Compute the odometry from the rotation of the first two driven wheels. Otherwise, it is the
    ground-truth pose in the world."""
    steering_wheel: str | None = None
    """Joint of a steering wheel, which turns in proportion to the steering angle."""
    max_steering_wheel: float = 0.0
    """Angle of the steering wheel at the maximum steering angle, rad."""
    distance_topic: str | None = None
    """Topic of the distance travelled, m. None: not published."""
    angle_topic: str | None = None
    """Topic of the mean angle of the steering joints, rad. None: not published."""
    drive: DriveConfig
    """Topics and rates."""


def reversed_angle(speed: Number, angle: Number) -> Number:
    """Returns a steering angle in rad with the sign inverted if the speed is negative."""
    return angle * copysign(1.0, speed)


class AckermannDrive(Drive):
    """Drives and steers a car from Twist commands and publishes odometry.

    Raises:
        UnknownNameError: A joint does not exist.
    """

    def __init__(self, scope: Scope, config: AckermannDriveConfig) -> None:
        super().__init__(scope)
        part, origin = self.part, self.origin
        self._config = config
        steering = (config.steering_left, config.steering_right)
        # The model contains the motors in the order in which they are requested.
        if config.steering_first:
            self._steering = self._servos(steering)
        limited = config.drive.limited_joints
        self._driven = [
            [Wheel(part, name, max_effort=None, limited=limited, origin=origin) for name in names]
            for names in (config.left, config.right)
        ]
        if not config.steering_first:
            self._steering = self._servos(steering)
        self._steered = [part.joint(name, origin=origin) for name in steering]
        self._fastest = [
            velocity_limit(part.description.joint(name)) if limited else math.inf
            for name in steering
        ]
        self._steering_wheel = None
        if config.steering_wheel is not None:
            self._steering_wheel = part.servo(config.steering_wheel, max_effort=None, origin=origin)
        self._speed, self._turn = Limiter(config.speed_limits), Limiter(config.turn_limits)
        self._reckoning = AxleReckoning(
            self._driven[0][0],
            self._driven[1][0],
            radius=config.radius,
            separation=config.driven_track,
        )
        self._Float = message_class("std_msgs/msg/Float32")
        self._distance, self._angle = (
            self.advertise(topic, "std_msgs/msg/Float32", rate=config.drive.odometry.rate or None)
            if topic is not None
            else None
            for topic in (config.distance_topic, config.angle_topic)
        )
        self.run(config.drive)

    def _servos(self, joints: Sequence[str]) -> list[ServoHandle]:
        return [self.part.servo(name, max_effort=None, origin=self.origin) for name in joints]

    def reset(self) -> None:
        super().reset()
        self._command = (0.0, 0.0)
        self._speed.reset()
        self._turn.reset()
        self._reckoning.begin()
        self._travelled = 0.0
        self._last_position: tuple[float, float] | None = None

    def command(self, forward: float, sideways: float, turn: float) -> None:  # noqa: ARG002
        self._command = (forward, turn)

    def commanded(self, forward: float, turn: float) -> tuple[float, float]:
        config = self._config
        if config.turn == "yaw rate":
            return forward, turn
        angle = clamp(reversed_angle(forward, turn), -config.max_steering, config.max_steering)
        return forward, forward * tan(angle) / config.wheel_base

    def update(self, seconds: float) -> None:
        self._actuate(seconds or _FIRST_PERIOD)
        if self._config.encoded:
            self._reckoning.read(seconds)
        if self._distance is not None:
            self._travel()

    def respond(self) -> None:
        config = self._config
        if config.speed_limits.is_instant and config.turn_limits.is_instant:
            self._actuate(_FIRST_PERIOD)

    def _actuate(self, seconds: float) -> None:
        """Commands the wheels and the steering, `seconds` after the last call."""
        config = self._config
        speed = self._speed.step(self._command[0], seconds)
        turn = self._turn.step(self._command[1], seconds)
        if config.turn == "yaw rate":
            middle = angle_of_turn(speed, turn, config.wheel_base)
        else:
            middle = reversed_angle(self._command[0], turn)
        middle = clamp(middle, -config.max_steering, config.max_steering)
        angles = wheel_angles(middle, config.wheel_base, config.steered_track)
        for servo, angle, fastest in zip(self._steering, angles, self._fastest, strict=True):
            servo.command_position(angle, max_velocity=fastest)
        factors = rim_factors(middle, config.wheel_base, config.driven_track)
        for wheels, factor in zip(self._driven, factors, strict=True):
            for wheel in wheels:
                wheel.command = speed * factor / config.radius
        if self._steering_wheel is not None:
            self._steering_wheel.command_position(
                middle * config.max_steering_wheel / config.max_steering
            )

    def motion(self) -> Motion:
        return self._reckoning.motion() if self._config.encoded else super().motion()

    def publish(self, time_ns: int) -> None:
        super().publish(time_ns)
        if self._distance is not None and self._distance.wanted:
            self._distance.publish(self._Float(self._travelled))
        if self._angle is not None and self._angle.wanted:
            left, right = self._steered
            self._angle.publish(self._Float((left.position + right.position) / 2))

    def _travel(self) -> None:
        """Adds the distance since the last call."""
        x, y, _ = self._base.place()[0]
        if self._last_position is not None:
            self._travelled += math.dist(self._last_position, (x, y))
        self._last_position = (x, y)
