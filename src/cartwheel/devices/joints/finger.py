"""An underactuated finger: one motor bends several joints by a tendon."""

from __future__ import annotations

import math
from dataclasses import dataclass

from cartwheel.component import Component, Scope
from cartwheel.devices.elementwise import Number, clamp
from cartwheel.errors import Origin


@dataclass(frozen=True, kw_only=True, slots=True)
class FingerJointConfig:
    name: str
    """Name of the joint."""
    scale: float
    """Angle of the motor divided by the angle of the joint; not 0."""
    origin: Origin | None = None
    """File and line for errors."""


@dataclass(frozen=True, kw_only=True, slots=True)
class FingerConfig:
    motor: str
    """Joint of the motor that pulls the tendon."""
    joints: tuple[FingerJointConfig, ...]
    """The joints of the finger."""


class Finger(Component):
    """Bends joints in proportion to a motor's angle, up to the joint limits.

    A joint that meets an obstacle exerts at most its effort limit; the others continue to bend.

    Raises:
        UnknownNameError: A joint does not exist.
    """

    def __init__(self, scope: Scope, config: FingerConfig) -> None:
        super().__init__(scope)
        part = self.part
        self._motor = part.joint(config.motor, origin=self.origin)
        self._joints = []
        for each in config.joints:
            servo = part.servo(each.name, max_effort=None, origin=each.origin)
            joint = part.description.joint(each.name)
            low, high = (joint.axis.lower, joint.axis.upper) if joint is not None else (None, None)
            low, high = -math.inf if low is None else low, math.inf if high is None else high
            self._joints.append((servo, each.scale, low, high))
        part.schedule(0, before=self._bend).reads_state = True

    def _bend(self) -> None:
        angle = self._motor.position
        for servo, scale, low, high in self._joints:
            servo.command_position(bent(angle, scale, low, high))


def bent(motor: Number, scale: float, low: float, high: float) -> Number:
    """Returns the angle in rad of a joint for an angle of the motor in rad.

    Args:
        motor: Angle of the motor.
        scale: Angle of the motor divided by the angle of the joint.
        low: Lower joint limit, rad.
        high: Upper joint limit, rad.
    """
    return clamp(motor / scale, low, high)
