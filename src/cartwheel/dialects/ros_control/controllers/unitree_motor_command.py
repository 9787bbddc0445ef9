"""``unitree_legged_control``: a leg motor, whose commands contain the gains."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.joints.leg_motor import COMMAND, LegMotor
from cartwheel.dialects.ros_control.controller import Controller
from cartwheel.dialects.ros_control.parameters import ignored, parameter


@dataclass(frozen=True, kw_only=True, slots=True)
class UnitreeJointParameters:
    joint: str = parameter("joint", role="joint", interface="effort", doc="Joint.")
    unused: None = ignored(
        "pid", doc="No effect, as in the original, which reads it only in a tuning build."
    )


class UnitreeJointController(Controller):
    """Controls one joint by ``command`` (MotorCmd): position, velocity and torque, with gains.

    The joint brakes until the first command. ``state`` (MotorState) is published at every update.
    Source: unitree_legged_control.
    """

    types: ClassVar[tuple[str, ...]] = ("unitree_legged_control/UnitreeJointController",)
    parameters = UnitreeJointParameters

    def configure(self, given: UnitreeJointParameters) -> None:
        self._motor = self.add(LegMotor(self.scope, self.claim(given.joint, "effort")))
        self.subscribe("command", COMMAND, self._motor.command)

    def start(self, time_ns: int) -> None:  # noqa: ARG002
        self._motor.brake()

    def update(self, time_ns: int, seconds: float) -> None:  # noqa: ARG002
        self._motor.update(seconds)
