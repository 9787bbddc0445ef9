"""A car with four driven wheels, whose steering angles are commands for position controllers."""

from __future__ import annotations

import math
from dataclasses import dataclass

from cartwheel.component import Scope
from cartwheel.devices.drives.commanded_joint import Wheel
from cartwheel.devices.drives.drive import Drive, DriveConfig
from cartwheel.messages import message_class

_FLOAT = "std_msgs/msg/Float64"


@dataclass(frozen=True, kw_only=True, slots=True)
class SteeringCommandsConfig:
    front: tuple[str, str]
    """Joints of the left and right front wheel, which are steered."""
    rear: tuple[str, str]
    """Joints of the left and right rear wheel."""
    angle_topics: tuple[str, str]
    """Topics of the left and right steering angle, rad (Float64)."""
    radius: float
    """Radius of the wheels, m."""
    wheel_base: float
    """Distance between the axles, m."""
    track: float
    """Distance between the front wheels, m."""
    lever: float
    """Distance from the middle at which the speeds of the left and right wheels are calculated, m.
    Half the track would be exact."""
    max_angle: float
    """Maximum steering angle, rad."""
    max_torque: float
    """Maximum torque of each wheel, N m."""
    drive: DriveConfig
    """Topics and rates."""


class SteeringCommandsDrive(Drive):
    """Drives four wheels from Twist commands, and publishes the steering angles.

    The steering angle has the sign of the commanded yaw rate, also in reverse. At standstill, a yaw
    rate steers to the maximum angle.

    Raises:
        UnknownNameError: A joint does not exist.
    """

    def __init__(self, scope: Scope, config: SteeringCommandsConfig) -> None:
        super().__init__(scope)
        self._config = config
        self._front, self._rear = (
            [
                Wheel(self.part, name, max_effort=config.max_torque, origin=self.origin)
                for name in names
            ]
            for names in (config.front, config.rear)
        )
        self._Float = message_class(_FLOAT)
        self._angles = [self.advertise(topic, _FLOAT) for topic in config.angle_topics]
        self.run(config.drive)

    def reset(self) -> None:
        super().reset()
        self._command = (0.0, 0.0)

    def command(self, forward: float, sideways: float, turn: float) -> None:  # noqa: ARG002
        self._command = (forward, turn)

    def update(self, seconds: float) -> None:  # noqa: ARG002
        speed, turn = self._command
        angles = self._wheel_angles(speed, turn)
        difference = math.copysign(turn, speed * turn) * self._config.lever if speed else 0.0
        for side, angle, front, rear in zip((-1, 1), angles, self._front, self._rear, strict=True):
            along = speed + side * difference
            rear.command = along / self._config.radius
            front.command = along / abs(math.cos(angle)) / self._config.radius
        for topic, angle in zip(self._angles, angles, strict=True):
            if topic.wanted:
                topic.publish(self._Float(angle))

    def _wheel_angles(self, speed: float, turn: float) -> tuple[float, float]:
        """Returns the left and the right steering angle, rad."""
        if turn == 0:
            return 0.0, 0.0
        config = self._config
        radius = abs(speed / turn)
        inner, outer = (
            min(math.atan2(config.wheel_base, radius + side * config.track / 2), config.max_angle)
            for side in (-1, 1)
        )
        return (inner, outer) if turn > 0 else (-outer, -inner)
