"""``unitree_legged_control``: a leg motor, whose commands contain the gains."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from cartwheel.devices.elementwise import clamp
from cartwheel.devices.joints.pid import DampedEffort, Pid, PidGains
from cartwheel.dialects.ros_control.controller import Controller
from cartwheel.dialects.ros_control.parameters import ignored, parameter
from cartwheel.messages import zero

_BRAKE, _SERVO = 0x00, 0x0A
"""Modes of a command. In any other mode the command is ignored."""
_NO_POSITION, _NO_VELOCITY = 2.146e9, 16000.0
"""Targets that disable their gain."""
_BRAKING = 20.0
"""N m s/rad."""


@dataclass(frozen=True, kw_only=True, slots=True)
class UnitreeJointParameters:
    joint: str = parameter("joint", role="joint", interface="effort", doc="Joint.")
    unused: None = ignored(
        "pid", doc="No effect, as in the original, which reads it only in a tuning build."
    )


class UnitreeJointController(Controller):
    """Controls one joint by ``command`` (MotorCmd): position, velocity and torque, with gains.

    The torque is ``Kp (q - position) + Kd (dq - velocity) + tau``, within the joint's limits. The
    joint brakes until the first command. ``state`` (MotorState) is published at every update.
    Source: unitree_legged_control.
    """

    types: ClassVar[tuple[str, ...]] = ("unitree_legged_control/UnitreeJointController",)

    parameters = UnitreeJointParameters

    def configure(self, given: UnitreeJointParameters) -> None:
        self._joint = self.claim(given.joint, "effort")
        self._set_target(PidGains(p=0.0, d=_BRAKING))
        self.subscribe("command", "unitree_legged_msgs/msg/MotorCmd", self._on_command)
        self._publisher = self.advertise("state", "unitree_legged_msgs/msg/MotorState")

    def start(self, time_ns: int) -> None:  # noqa: ARG002
        self._set_target(PidGains(p=0.0, d=_BRAKING))

    def update(self, time_ns: int, seconds: float) -> None:  # noqa: ARG002
        joint = self._joint
        command = self._pid.position(
            self._position - joint.position,
            seconds,
            target=self._position,
            rate=self._velocity,
            lightness=joint.lightness,
        )
        joint.set_effort(DampedEffort(command.effort + self._torque, command.damping))
        if self._publisher.wanted:
            message = zero("unitree_legged_msgs/msg/MotorState")
            message.q, message.dq, message.tauEst = joint.position, joint.velocity, joint.effort
            self._publisher.publish(message)

    def _set_target(
        self, gains: PidGains, *, position: float = 0.0, velocity: float = 0.0, torque: float = 0.0
    ) -> None:
        """Sets the gains, and the targets in rad, rad/s and N m."""
        self._pid = Pid(gains)
        self._position, self._velocity, self._torque = position, velocity, torque

    def _on_command(self, message: Any) -> None:
        numbers = (message.q, message.dq, message.tau, message.Kp, message.Kd)
        if not all(math.isfinite(each) for each in numbers):
            return
        if message.mode == _BRAKE:
            self._set_target(PidGains(p=0.0, d=_BRAKING))
        elif message.mode == _SERVO:
            position, velocity, torque, p, d = (float(each) for each in numbers)
            limits = self._joint.limits
            self._set_target(
                PidGains(p=0.0 if _matches(position, _NO_POSITION) else p,
                      d=0.0 if _matches(velocity, _NO_VELOCITY) else d),
                position=clamp(position, limits.lower, limits.upper),
                velocity=clamp(velocity, -limits.velocity, limits.velocity),
                torque=clamp(torque, -limits.effort, limits.effort),
            )  # fmt: skip


def _matches(value: float, mark: float) -> bool:
    """Whether a 32-bit value is the given marker."""
    return math.isclose(value, mark, rel_tol=1e-6)
