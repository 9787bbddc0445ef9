"""Motors of legged robots, whose commands contain the gains."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from cartwheel.component import Component, Scope
from cartwheel.devices.elementwise import clamp
from cartwheel.devices.joints.actuator import JointActuator
from cartwheel.devices.joints.limits import JointLimits
from cartwheel.devices.joints.pid import DampedEffort, PidGains, position_effort
from cartwheel.messages import message_class

COMMAND = "unitree_legged_msgs/msg/MotorCmd"
_STATE = "unitree_legged_msgs/msg/MotorState"
_BRAKE, SERVO = 0x00, 0x0A
"""Modes of a command. In any other mode the command is ignored."""
_NO_POSITION, _NO_VELOCITY = 2.146e9, 16000.0
"""Targets that disable their gain."""
_BRAKING = PidGains(p=0.0, d=20.0)


@dataclass(frozen=True, kw_only=True, slots=True)
class LegMotorTarget:
    """What a motor does: ``p (position - q) + d (velocity - dq) + torque``, with the state q, dq.
    By default it brakes.
    """

    gains: PidGains = _BRAKING
    position: float = 0.0
    """rad."""
    velocity: float = 0.0
    """rad/s."""
    torque: float = 0.0
    """N m."""


def leg_motor_target(message: Any, limits: JointLimits) -> LegMotorTarget | None:
    """Returns the target of a MotorCmd message, within the limits; None if it is ignored."""
    numbers = [float(getattr(message, name)) for name in ("q", "dq", "tau", "Kp", "Kd")]
    if not all(math.isfinite(each) for each in numbers):
        return None
    if message.mode == _BRAKE:
        return LegMotorTarget()
    if message.mode != SERVO:
        return None
    position, velocity, torque, p, d = numbers
    return LegMotorTarget(
        gains=PidGains(
            p=0.0 if _matches(position, _NO_POSITION) else p,
            d=0.0 if _matches(velocity, _NO_VELOCITY) else d,
        ),
        position=clamp(position, limits.lower, limits.upper),
        velocity=clamp(velocity, -limits.velocity, limits.velocity),
        torque=clamp(torque, -limits.effort, limits.effort),
    )


class LegMotor(Component):
    """Controls a joint by position, velocity and torque, and publishes ``state`` (MotorState).

    Source: unitree_legged_control.

    Args:
        scope: Names of the topics.
        joint: The joint.
    """

    def __init__(self, scope: Scope, joint: JointActuator) -> None:
        super().__init__(scope)
        self._joint = joint
        self._target = LegMotorTarget()
        self._publisher = self.advertise("state", _STATE)

    def brake(self) -> None:
        """Brakes until the next command."""
        self._target = LegMotorTarget()

    def command(self, message: Any) -> None:
        """Follows a MotorCmd message."""
        self._target = leg_motor_target(message, self._joint.limits) or self._target

    def update(self, seconds: float) -> None:
        """Commands the joint; `seconds` is the time since the last call."""
        joint, target = self._joint, self._target
        effort, damping = position_effort(
            target.gains,
            target.position - joint.position,
            0.0,
            rate=target.velocity,
            seconds=seconds,
            lightness=joint.lightness,
        )
        joint.set_effort(DampedEffort(effort + target.torque, damping))
        if self._publisher.wanted:
            self._publisher.publish(
                message_class(_STATE)(q=joint.position, dq=joint.velocity, tauEst=joint.effort)
            )


def _matches(value: float, mark: float) -> bool:
    """Whether a 32-bit value is the given marker."""
    return math.isclose(value, mark, rel_tol=1e-6)
