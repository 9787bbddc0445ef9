"""``unitree_legged_control``: a leg motor, whose commands contain the gains."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.joints.leg_motor import COMMAND, SERVO, LegMotor
from cartwheel.devices.joints.pid import PidGains
from cartwheel.dialects.ros_control.controller import Controller
from cartwheel.dialects.ros_control.parameters import ignored, parameter
from cartwheel.dialects.ros_control.settings import Settings


def _read_gains(settings: Settings) -> PidGains:
    return PidGains(p=settings.number("p", 0.0), d=settings.number("d", 0.0))


@dataclass(frozen=True, kw_only=True, slots=True)
class UnitreeJointParameters:
    joint: str = parameter("joint", role="joint", interface="effort", doc="Joint.")
    gains: PidGains = parameter(
        "pid",
        read=_read_gains,
        default=PidGains(p=0.0),
        role="gains",
        doc="Gains `p` and `d` of manual positions, such as those from the web interface. Without "
        "`p`, there are none. They have no effect on `command`, which contains its own gains.",
    )
    unused: None = ignored("pid")


class UnitreeJointController(Controller):
    """Controls one joint by ``command`` (MotorCmd): position, velocity and torque, with gains.

    The joint brakes until the first command. ``state`` (MotorState) is published at every update.
    Source: unitree_legged_control.
    """

    types: ClassVar[tuple[str, ...]] = ("unitree_legged_control/UnitreeJointController",)
    parameters = UnitreeJointParameters
    holds = False

    def configure(self, given: UnitreeJointParameters) -> None:
        self._motor = self.add(LegMotor(self.scope, self.claim(given.joint, "effort")))
        self.subscribe("command", COMMAND, self._motor.command)
        if given.gains.p > 0:
            self.accept_positions(lambda wanted, _: self._move(wanted[given.joint], given.gains))

    def _move(self, position: float, gains: PidGains) -> None:
        """Moves to a manual position in rad or m."""
        self.publish_command(
            "command",
            COMMAND,
            mode=SERVO,
            q=position,
            dq=0.0,
            tau=0.0,
            Kp=gains.p,
            Kd=gains.d,
            reserve=[0, 0, 0],
        )

    def start(self, time_ns: int) -> None:  # noqa: ARG002
        self._motor.brake()

    def update(self, time_ns: int, seconds: float) -> None:  # noqa: ARG002
        self._motor.update(seconds)
