"""A tricycle: one wheel that is driven and steered, and two wheels that roll freely."""

from __future__ import annotations

import math
from dataclasses import dataclass

from cartwheel.component import Scope
from cartwheel.description.kinematics import link_poses
from cartwheel.devices.drives.commanded_joint import Wheel
from cartwheel.devices.drives.drive import Drive, DriveConfig
from cartwheel.devices.drives.reckoning import AxleReckoning, Motion
from cartwheel.devices.elementwise import Number, clamp, where
from cartwheel.devices.ramp import ramp
from cartwheel.geometry import rotate

_QUARTER = math.pi / 2
"""Maximum steering angle, rad."""


@dataclass(frozen=True, kw_only=True, slots=True)
class TricycleDriveConfig:
    wheel: str
    """Joint of the driven wheel."""
    steering: str
    """Joint that steers the driven wheel."""
    left: str
    """Joint of the left free wheel."""
    right: str
    """Joint of the right free wheel."""
    wheel_radius: float
    """Radius of the driven wheel, m."""
    free_radius: float
    """Radius of the free wheels, m."""
    separation: float
    """Distance between the free wheels, m."""
    torque: float
    """Maximum torque of the motor and, if the steering rate is limited, of the steering, N m."""
    acceleration: float = 0.0
    """Maximum acceleration of the driven wheel, rad/s². 0: no limit."""
    deceleration: float = 0.0
    """Maximum deceleration of the driven wheel, rad/s². 0: no limit."""
    steering_rate: float = 0.0
    """Maximum steering rate, rad/s. 0: no limit."""
    encoded: bool = False
    """Compute the odometry from the rotation of the free wheels. Otherwise, it is the ground-truth
    pose in the world."""
    drive: DriveConfig
    """Topics and rates."""


def next_speed(
    speed: Number, target: Number, *, acceleration: float, deceleration: float, seconds: float
) -> Number:
    """Returns the speed of a wheel after a time step, rad/s.

    Args:
        speed: Current speed, rad/s.
        target: Commanded speed, rad/s.
        acceleration: Maximum acceleration, rad/s²; 0: no limit.
        deceleration: Maximum deceleration, rad/s²; 0: no limit.
        seconds: Duration of the time step, s.
    """
    most = where(abs(target) < abs(speed), deceleration, acceleration)
    return where(most > 0, ramp(speed, target, most * seconds), target)


def next_angle(angle: Number, target: Number, *, rate: float, seconds: float) -> Number:
    """Returns a steering angle after a time step, rad, of at most ±90°.

    Args:
        angle: Current angle, rad.
        target: Commanded angle, rad.
        rate: Maximum steering rate, rad/s; 0: no limit.
        seconds: Duration of the time step, s.
    """
    target = clamp(target, -_QUARTER, _QUARTER)
    return ramp(angle, target, rate * seconds) if rate > 0 else target


class TricycleDrive(Drive):
    """Drives and steers one wheel from Twist commands and publishes odometry.

    ``linear.x`` is the speed of the driven wheel in m/s, ``angular.z`` its steering angle in rad.

    Raises:
        UnknownNameError: A joint does not exist.
    """

    def __init__(self, scope: Scope, config: TricycleDriveConfig) -> None:
        super().__init__(scope)
        part, origin = self.part, self.origin
        self._config = config
        names = (config.steering, config.wheel, config.left, config.right)
        _, _, left, right = (part.joint(name, origin=origin) for name in names)
        self._reckoning = AxleReckoning(
            left, right, radius=config.free_radius, separation=config.separation
        )
        # Without a limit on the rate, the angle must be reached immediately.
        torque = config.torque if config.steering_rate > 0 else None
        self._steering = part.servo(config.steering, max_effort=torque, origin=origin)
        self._wheel = Wheel(part, config.wheel, max_effort=config.torque, origin=origin)
        self.run(config.drive)

    def reset(self) -> None:
        super().reset()
        self._command = (0.0, 0.0)
        self._speed = self._angle = 0.0
        self._reckoning.begin()

    def command(self, forward: float, sideways: float, turn: float) -> None:  # noqa: ARG002
        self._command = (forward, turn)

    def commanded(self, forward: float, turn: float) -> tuple[float, float]:
        angle = clamp(turn, -_QUARTER, _QUARTER)
        return forward * math.cos(angle), forward * math.sin(angle) / self._wheel_base()

    def _wheel_base(self) -> float:
        """Distance of the steered wheel ahead of the middle of the free wheels, m.

        Ahead is where the driven wheel rolls. A robot steered by a wheel behind the others turns to
        the right at a positive angle.
        """
        config, description = self._config, self.part.description
        poses = link_poses(description, {})
        steered, left, right = (
            poses[joint.child].position
            for name in (config.steering, config.left, config.right)
            if (joint := description.joint(name)) is not None
        )
        middle = [(a + b) / 2 for a, b in zip(left, right, strict=True)]
        wheel = description.joint(config.wheel)
        assert wheel is not None
        pose = poses[wheel.child]
        axis = rotate(pose.orientation, rotate(wheel.pose.orientation, wheel.axis.xyz))
        ahead = (steered[0] - middle[0]) * axis[1] - (steered[1] - middle[1]) * axis[0]
        return math.copysign(math.dist(steered[:2], middle[:2]), ahead)

    def update(self, seconds: float) -> None:
        config = self._config
        forward, angle = self._command
        self._speed = next_speed(
            self._speed,
            forward / config.wheel_radius,
            acceleration=config.acceleration,
            deceleration=config.deceleration,
            seconds=seconds,
        )
        self._wheel.command = self._speed
        self._angle = next_angle(self._angle, angle, rate=config.steering_rate, seconds=seconds)
        self._steering.command_position(self._angle)
        if config.encoded:
            self._reckoning.read(seconds)

    def motion(self) -> Motion:
        return self._reckoning.motion() if self._config.encoded else super().motion()
